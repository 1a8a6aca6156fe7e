// frictionCG: unilateral contact with Coulomb friction for FreeFEM, by the conjugate gradient of
// Raous and Barbarin (1992).  Registers frictionalContactCG; the numerics are in core/.
//
// SPDX-License-Identifier: GPL-3.0-or-later

#include "freefem/freefem.h"

#include <chrono>
#include <cmath>

#include "core/solver.h"
#include "freefem/contact_boundary.h"
#include "freefem/matrix.h"

using namespace frictioncg;

namespace {

constexpr const char* operator_name = "frictionalContactCG";

basicAC_F0::name_and_type parameters[] = {
    {"mu", &typeid(double)},             // friction coefficient
    {"gap", &typeid(double)},            // [length]
    {"normal", &typeid(E_Array)},        //
    {"slidinglimit", &typeid(double)},   // [force/area]
    {"uold", &typeid(KN_<double>)},      // [length]
    {"init", &typeid(KN_<double>)},      // [length]
    {"method", &typeid(string*)},        //
    {"reg", &typeid(string*)},           //
    {"regeps", &typeid(double)},         // [length]
    {"precon", &typeid(string*)},        //
    {"omega", &typeid(double)},          //
    {"step", &typeid(string*)},          //
    {"tol", &typeid(double)},            //
    {"nbiter", &typeid(long)},           //
    {"verb", &typeid(long)},             //
    {"status", &typeid(long*)},          // out
    {"residual", &typeid(double*)},      // out
    {"iterations", &typeid(long*)},      // out
    {"force", &typeid(KN<double>*)},     // out [force]
    {"state", &typeid(KN<long>*)},       // out
    {"history", &typeid(KNM<double>*)},  // out
};
enum Parameter {
  p_mu, p_gap, p_normal, p_slidinglimit, p_uold, p_init, p_method, p_reg, p_regeps, p_precon,
  p_omega, p_step, p_tol, p_nbiter, p_verb, p_status, p_residual, p_iterations, p_force, p_state,
  p_history, parameter_count
};
static_assert(sizeof(parameters) / sizeof(*parameters) == parameter_count, "one name each");

/// A table of the values that a string parameter may take.
template <class T>
struct Choice {
  const char* name;
  T value;
};
constexpr Choice<Method> methods[] = {
    {"GC1", Method::gc1}, {"GC2", Method::gc2}, {"GC3", Method::gc3}, {"SORP", Method::sorp}};
constexpr Choice<Regularization> regularizations[] = {{"polynomial", Regularization::polynomial},
                                                      {"sqrt", Regularization::square_root},
                                                      {"tanh", Regularization::log_cosh}};
constexpr Choice<Precon> preconditioners[] = {{"hessian-ssor", Precon::hessian_ssor},
                                              {"hessian-diagonal", Precon::hessian_diagonal},
                                              {"ssor", Precon::ssor},
                                              {"diagonal", Precon::diagonal},
                                              {"none", Precon::none}};
constexpr Choice<Step> steps[] = {
    {"exact", Step::exact}, {"newton", Step::newton}, {"falseposition", Step::false_position}};

template <class T, std::size_t count>
T choose(const char* parameter, const std::string& value, const Choice<T> (&choices)[count]) {
  std::string known;
  for (const Choice<T>& c : choices) {
    if (value == c.name) return c.value;
    known += std::string(known.empty() ? "\"" : ", \"") + c.name + "\"";
  }
  throw IllegalInput(std::string(parameter) + " = \"" + value + "\" is unknown; choose from " +
                     known);
}

template <class T, std::size_t count>
const char* name_of(T value, const Choice<T> (&choices)[count]) {
  for (const Choice<T>& c : choices)
    if (value == c.value) return c.name;
  return "";
}

struct StatusText {
  const char* name;
  const char* remedy;
};
StatusText describe(Status status) {
  switch (status) {
    case Status::converged: return {"converged", ""};
    case Status::max_iterations: return {"max_iterations", "raise nbiter, or try another precon"};
    case Status::stagnated: return {"stagnated", "tol is below what this matrix allows; raise tol"};
    case Status::no_equilibrium:
      return {"no_equilibrium", "contact and friction cannot hold this load; check the supports"};
    case Status::not_positive_definite:
      return {"not_positive_definite", "A must be positive semi-definite; check its coefficients"};
    case Status::fixed_point_diverged:
      return {"fixed_point_diverged", "mu is large for this scene; apply the load in increments"};
    case Status::regularized:
      return {"regularized", "regeps limits the accuracy; lower it, leave it out, or raise tol"};
  }
  return {"unknown", ""};
}

/// Rows (seconds, iteration, certificate residual); its own cost is not counted.
class History final : public Observer {
 public:
  explicit History(const ContactProblem& problem) : problem_(problem), start_(now()) {}
  void iterate(Index iteration, const Vector& x) override {
    const double at = now();
    rows_.push_back({at - start_, double(iteration), certify(problem_, x).residual});
    start_ += now() - at;
  }
  void write(KNM<double>* out) const {
    out->resize(static_cast<long>(rows_.size()), 3);
    for (std::size_t k = 0; k < rows_.size(); ++k)
      for (int c = 0; c < 3; ++c) (*out)(static_cast<int>(k), c) = rows_[k][c];
  }

 private:
  static double now() {
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
  }
  const ContactProblem& problem_;
  double start_;
  std::vector<std::array<double, 3>> rows_;
};

/// The expressions of one call of the operator, for V = v_fes (2D) or v_fes3 (3D).
template <class V, class LabelArgument>
class Operator : public E_F0mps {
 public:
  using Result = KN_<double>;  // what OneOperatorCode returns to the script
  using pfes = typename V::pfes;
  using Space = typename V::FESpace;
  static constexpr int d = Dimension<Space>::d;

  explicit Operator(const basicAC_F0& args) {
    args.SetNameParam(parameter_count, parameters, named_);
    A_ = to<Matrice_Creuse<double>*>(args[0]);
    b_ = to<KN_<double>>(args[1]);
    Vh_ = to<pfes*>(args[2]);
    if constexpr (std::is_same_v<LabelArgument, E_Array>) {
      const E_Array* list = dynamic_cast<const E_Array*>(args[3].LeftValue());
      for (int k = 0; list && k < list->size(); ++k) labels_.push_back(to<long>((*list)[k]));
    } else {
      labels_.push_back(to<LabelArgument>(args[3]));
    }
    if (named_[p_normal]) {
      const E_Array* n = dynamic_cast<const E_Array*>(named_[p_normal]);
      if (!n || n->size() != d)
        CompileError(d == 2 ? "frictionalContactCG: normal = [nx, ny] on a 2D mesh"
                            : "frictionalContactCG: normal = [nx, ny, nz] on a 3D mesh");
      for (int c = 0; c < d; ++c) normal_[c] = to<double>((*n)[c]);
    }
  }
  static ArrayOfaType typeargs() {
    return ArrayOfaType(atype<Matrice_Creuse<double>*>(), atype<KN_<double>>(), atype<pfes*>(),
                        atype<LabelArgument>());
  }
  static E_F0* f(const basicAC_F0& args) { return new Operator(args); }

  AnyType operator()(Stack stack) const override {
    try {
      return SetAny<KN_<double>>(run(stack));
    } catch (const IllegalInput& e) {
      ExecError(std::string(operator_name) + ": " + e.what());
    } catch (const std::bad_alloc&) {
      ExecError(std::string(operator_name) + ": not enough memory");
    }
    return Nothing;
  }

 private:
  template <class T>
  T value(Stack stack, Parameter p, T otherwise) const {
    return named_[p] ? GetAny<T>((*named_[p])(stack)) : otherwise;
  }
  template <class T, std::size_t count>
  T chosen(Stack stack, Parameter p, const Choice<T> (&choices)[count], T otherwise) const {
    return named_[p] ? choose(parameters[p].name, *GetAny<string*>((*named_[p])(stack)), choices)
                     : otherwise;
  }
  template <class T>
  T* output(Stack stack, Parameter p) const {
    return named_[p] ? GetAny<T*>((*named_[p])(stack)) : nullptr;
  }

  std::vector<long> labels(Stack stack) const;
  Settings settings(Stack stack) const;
  Vector at_nodes(Stack stack, Parameter p, const Space& Vh, const std::vector<BoundaryNode>& nodes,
                  const char* rule) const;
  void set_normals(Stack stack, const Space& Vh, std::vector<BoundaryNode>& nodes) const;
  KN_<double> run(Stack stack) const;
  void report_plan(const LocalSystem& system, const Settings& s, const Plan& plan) const;

  Expression named_[parameter_count];
  Expression A_, b_, Vh_, normal_[3] = {nullptr, nullptr, nullptr};
  std::vector<Expression> labels_;
};

template <class V, class L>
std::vector<long> Operator<V, L>::labels(Stack stack) const {
  std::vector<long> all;
  if constexpr (std::is_same_v<L, KN_<long>>) {
    const KN_<long> list = GetAny<KN_<long>>((*labels_[0])(stack));
    for (long k = 0; k < list.N(); ++k) all.push_back(list[k]);
  } else {
    for (Expression e : labels_) all.push_back(GetAny<long>((*e)(stack)));
  }
  if (all.empty()) throw IllegalInput("labels is empty; name the boundary that may touch");
  return all;
}

template <class V, class L>
Settings Operator<V, L>::settings(Stack stack) const {
  Settings s;
  s.method = chosen(stack, p_method, methods, s.method);
  s.reg = chosen(stack, p_reg, regularizations, s.reg);
  s.precon = chosen(stack, p_precon, preconditioners, s.precon);
  s.step = chosen(stack, p_step, steps, s.step);
  s.regeps = value(stack, p_regeps, s.regeps);
  s.omega = value(stack, p_omega, s.omega);
  s.tol = value(stack, p_tol, s.tol);
  s.nbiter = static_cast<Index>(value<long>(stack, p_nbiter, s.nbiter));
  const auto require = [](bool holds, const char* name, double x, const char* rule) {
    if (holds) return;
    std::ostringstream m;
    m << name << " = " << x << "; " << rule;
    throw IllegalInput(m.str());
  };
  require(!named_[p_regeps] || (s.regeps > 0 && std::isfinite(s.regeps)), "regeps", s.regeps,
          "the regularization is a length > 0; leave it out to scale it from the scene");
  require(!named_[p_omega] || (s.omega > 0 && s.omega < 2), "omega", s.omega,
          "a relaxation parameter lies between 0 and 2");
  require(s.tol > 0 && s.tol < 1, "tol", s.tol, "the tolerance lies between 0 and 1");
  require(!named_[p_nbiter] || s.nbiter > 0, "nbiter", s.nbiter,
          "the bound on the iterations is >= 1");
  if (s.method == Method::sorp)
    for (Parameter p : {p_reg, p_regeps, p_precon, p_step})
      if (named_[p])
        throw IllegalInput(std::string(parameters[p].name) +
                           " has no meaning with method=\"SORP\", which neither regularizes nor "
                           "preconditions; leave it out");
  return s;
}

/// A parameter of the laws, evaluated at each contact node.
template <class V, class L>
Vector Operator<V, L>::at_nodes(Stack stack, Parameter p, const Space& Vh,
                                const std::vector<BoundaryNode>& nodes, const char* rule) const {
  Vector result = Vector::Zero(static_cast<Index>(nodes.size()));
  if (!named_[p]) return result;
  MeshPoint* mp = MeshPointStack(stack);
  const MeshPoint saved = *mp;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Dimension<Space>::set_point(mp, Vh, nodes[k]);
    result[k] = GetAny<double>((*named_[p])(stack));
    if (!std::isfinite(result[k]) || (p != p_gap && result[k] < 0)) {
      *mp = saved;
      std::ostringstream m;
      m << parameters[p].name << " = " << result[k] << " at " << place(nodes[k], d) << "; " << rule;
      throw IllegalInput(m.str());
    }
  }
  *mp = saved;
  return result;
}

template <class V, class L>
void Operator<V, L>::set_normals(Stack stack, const Space& Vh,
                                 std::vector<BoundaryNode>& nodes) const {
  if (!normal_[0]) return;
  MeshPoint* mp = MeshPointStack(stack);
  const MeshPoint saved = *mp;
  for (BoundaryNode& node : nodes) {
    Dimension<Space>::set_point(mp, Vh, node);
    std::array<double, 3> n{};
    double norm = 0;
    for (int c = 0; c < d; ++c) {
      n[c] = GetAny<double>((*normal_[c])(stack));
      norm = std::hypot(norm, n[c]);
    }
    if (!(norm > 0) || !std::isfinite(norm)) {
      *mp = saved;
      throw IllegalInput("normal has no direction at " + place(node, d) +
                         "; give the outward normal of the body, of any length > 0");
    }
    for (int c = 0; c < d; ++c) node.point.normal[c] = n[c] / norm;
  }
  *mp = saved;
}

template <class V, class L>
KN_<double> Operator<V, L>::run(Stack stack) const {
  pfes* pVh = GetAny<pfes*>((*Vh_)(stack));
  const Space* Vh = pVh && *pVh ? static_cast<Space*>(**pVh) : nullptr;
  if (!Vh) throw IllegalInput("Vh is not a finite-element space");
  const long n = Vh->NbOfDF;
  const Settings s = settings(stack);
  if (named_[p_mu] && named_[p_slidinglimit])
    throw IllegalInput(
        "mu and slidinglimit are both given; Coulomb friction takes mu, a given limit slidinglimit");

  std::vector<BoundaryNode> nodes = contact_nodes(*Vh, labels(stack));
  const Triplets A = triplets(GetAny<Matrice_Creuse<double>*>((*A_)(stack)), n);
  const Vector b = checked_vector(GetAny<KN_<double>>((*b_)(stack)), "b", n);
  Vector u_old, u_init;
  if (named_[p_uold])
    u_old = checked_vector(GetAny<KN_<double>>((*named_[p_uold])(stack)), "uold", n);
  if (named_[p_init])
    u_init = checked_vector(GetAny<KN_<double>>((*named_[p_init])(stack)), "init", n);
  set_normals(stack, *Vh, nodes);
  const Vector gap = at_nodes(stack, p_gap, *Vh, nodes, "the gap is a finite length");
  const Vector mu = at_nodes(stack, p_mu, *Vh, nodes, "a friction coefficient is >= 0");
  Vector limit =
      at_nodes(stack, p_slidinglimit, *Vh, nodes, "a sliding limit is a traction >= 0");
  std::vector<ContactPoint> points;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    limit[k] *= nodes[k].weight;
    nodes[k].point.friction = mu[k] > 0 || limit[k] > 0;
    points.push_back(nodes[k].point);
  }
  LocalSystem system(A, d, std::move(points));
  if (system.nodes() == 0)
    throw IllegalInput(
        "labels name no node that could touch: Dirichlet conditions hold the normal displacement of "
        "all of them");
  system.set_load(b, u_old, gap);
  const bool coulomb = mu.maxCoeff() > 0, tresca = limit.maxCoeff() > 0;
  system.set_law(coulomb  ? Law::coulomb
                 : tresca ? Law::tresca
                          : Law::frictionless,
                 coulomb ? mu : limit);

  const long verb = value<long>(stack, p_verb, std::min(verbosity, 1L));
  if (verb > 0) report_plan(system, s, make_plan(system.problem(), s));
  History history(system.problem());
  KNM<double>* history_out = output<KNM<double>>(stack, p_history);
  const Vector x0 =
      u_init.size() == 0
          ? Vector()
          : system.to_local(u_old.size() == 0 ? u_init : Vector(u_init - u_old));
  const Solution result =
      solve(system.problem(), s, x0, history_out ? &history : nullptr);

  const StatusText text = describe(result.status);
  if (verb > 0) {
    std::cout << " -- " << operator_name << ": " << text.name << ", residual "
              << result.certificate.residual << ", " << result.iterations << " iterations";
    if (result.passes > 0) std::cout << " in " << result.passes << " passes of the fixed point";
    if (result.eps > 0) std::cout << ", regeps " << result.eps;
    std::cout << std::endl;
  }
  long* status_out = output<long>(stack, p_status);
  if (result.status != Status::converged && !status_out) {
    std::ostringstream m;
    m << "not converged (" << text.name << ") after " << result.iterations
      << " iterations: residual " << result.certificate.residual << ", tol " << s.tol << "; "
      << text.remedy << "; pass status=... to get the field all the same";
    throw IllegalInput(m.str());
  }
  if (status_out) *status_out = static_cast<long>(result.status);
  if (double* out = output<double>(stack, p_residual)) *out = result.certificate.residual;
  if (long* out = output<long>(stack, p_iterations)) *out = result.iterations;
  if (KN<double>* out = output<KN<double>>(stack, p_force)) {
    const Vector force = system.force_to_global(result.certificate.r);
    out->resize(n);
    for (long i = 0; i < n; ++i) (*out)[i] = force[i];
  }
  if (KN<long>* out = output<KN<long>>(stack, p_state)) {
    out->resize(n);
    *out = 0L;
    for (Index k = 0; k < system.nodes(); ++k)
      for (int c = 0; c < d; ++c)
        (*out)[nodes[system.point(k)].point.dof[c]] = static_cast<long>(result.state[k]);
  }
  if (history_out) history.write(history_out);

  KN<double>* u = Add2StackOfPtr2Free(stack, new KN<double>(n));
  const Vector field = system.to_global(result.x);
  for (long i = 0; i < n; ++i) (*u)[i] = field[i];
  return *u;
}

/// What the scene needs, and what it does not.
template <class V, class L>
void Operator<V, L>::report_plan(const LocalSystem& system, const Settings& s,
                                 const Plan& plan) const {
  std::cout << " -- " << operator_name << ": " << d << "D, " << plan.dofs << " dofs, " << plan.nodes
            << " contact nodes, ";
  switch (plan.law) {
    case Law::frictionless: std::cout << "no friction"; break;
    case Law::tresca: std::cout << "given sliding limit"; break;
    case Law::coulomb: std::cout << "Coulomb friction"; break;
  }
  std::cout << "; " << name_of(s.method, methods);
  if (s.method != Method::sorp) std::cout << ", " << name_of(s.precon, preconditioners);
  if (plan.regularization) std::cout << ", " << name_of(s.reg, regularizations);
  std::cout << "; left out:";
  const char* separator = " ";
  const auto left_out = [&](bool absent, const char* what) {
    if (!absent) return;
    std::cout << separator << what;
    separator = ", ";
  };
  left_out(!system.rotated(), "rotation");
  left_out(!plan.fixed_point, "fixed point");
  left_out(plan.tangents == 0, "tangential laws");
  left_out(!plan.regularization, "regularization");
  left_out(!named_[p_uold], "previous state");
  left_out(!named_[p_history], "history");
  std::cout << std::endl;
}

template <class V>
void register_for() {
  Global.Add(operator_name, "(", new OneOperatorCode<Operator<V, long>>());
  Global.Add(operator_name, "(", new OneOperatorCode<Operator<V, KN_<long>>>());
  Global.Add(operator_name, "(", new OneOperatorCode<Operator<V, E_Array>>());
}

void init() {
  const double compiled = std::strtod(FREEFEM_VERSION, nullptr);
  if (std::abs(VersionNumber() - compiled) > 1e-6) {
    std::ostringstream m;
    m << "frictionCG was built for FreeFEM " << FREEFEM_VERSION << " but runs in "
      << VersionNumber() << "; rebuild it with `make`";
    throw ErrorLoad(m.str().c_str(), 1);
  }
  register_for<v_fes>();
  register_for<v_fes3>();
}

}  // namespace

LOADFUNC(init)
