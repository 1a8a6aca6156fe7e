// frictionCG: unilateral contact with Coulomb friction for FreeFEM, by the conjugate gradient of
// Raous and Barbarin (1992).  Registers frictionalContactCG and contactproblem: arguments in,
// results out, errors translated; the numerics are in core/.
//
// SPDX-License-Identifier: GPL-3.0-or-later

#include "freefem/freefem.h"

#include "freefem/arguments.h"
#include "freefem/pose.h"

using namespace frictioncg;

namespace {

constexpr const char* constructor_name = "contactProblem";

struct StatusText {
  const char* name;
  const char* remedy;
};
StatusText describe(Status status) {
  switch (status) {
    case Status::converged:
      return {"converged", ""};
    case Status::max_iterations:
      return {"max_iterations", "raise nbiter, or try another precon"};
    case Status::stagnated:
      return {"stagnated", "tol is below what this matrix allows; raise tol"};
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
  explicit History(const ContactProblem& problem) : problem_(problem), start_(cpu_seconds()) {}
  void iterate(Index iteration, const Vector& x) override {
    const double at = cpu_seconds();
    rows_.push_back({at - start_, double(iteration), certify(problem_, x).residual});
    start_ += cpu_seconds() - at;
  }
  void write(KNM<double>* out) const {
    out->resize(static_cast<long>(rows_.size()), 3);
    for (std::size_t k = 0; k < rows_.size(); ++k)
      for (int c = 0; c < 3; ++c) (*out)(static_cast<int>(k), c) = rows_[k][c];
  }

 private:
  const ContactProblem& problem_;
  double start_;
  std::vector<std::array<double, 3>> rows_;
};

/// What the scene needs, and what it does not.
void report_plan(const Arguments& args, const Scene& scene, const ContactProblem& problem,
                 const Settings& s) {
  const Plan plan = make_plan(problem, s);
  std::cout << " -- " << operator_name << ": " << scene.d << "D, " << plan.dofs << " dofs, "
            << plan.nodes << " contact nodes, ";
  switch (plan.law) {
    case Law::frictionless:
      std::cout << "no friction";
      break;
    case Law::tresca:
      std::cout << "given sliding limit";
      break;
    case Law::coulomb:
      std::cout << "Coulomb friction";
      break;
  }
  if (scene.bilateral) std::cout << ", bilateral";
  if (scene.system->rotated()) std::cout << ", frames rotated";
  if (plan.nodes == 0)
    std::cout << "; Dirichlet conditions hold every normal displacement: a plain linear solve";
  std::cout << "; " << name_of(s.method, methods);
  if (plan.regularization) std::cout << ", " << name_of(s.reg, regularizations);
  std::cout << "; left out:";
  const char* separator = " ";
  const auto left_out = [&](bool absent, const char* what) {
    if (!absent) return;
    std::cout << separator << what;
    separator = ", ";
  };
  left_out(!scene.system->rotated(), "rotation");
  left_out(!plan.fixed_point, "fixed point");
  left_out(plan.tangents == 0, "tangential laws");
  left_out(!plan.regularization, "regularization");
  left_out(!args.has(p_uold), "previous state");
  left_out(!args.has(p_history), "history");
  std::cout << std::endl;
}

/// The outward normal of the laws at each contact node, by components; zero elsewhere (ndof).
void write_normals(const Scene& scene, KN<double>* out) {
  out->resize(scene.ndof);
  *out = 0.;
  for (Index k = 0; k < scene.system->nodes(); ++k) {
    const ContactPoint& point = scene.nodes[scene.system->node(k).point].point;
    for (int c = 0; c < scene.d; ++c) (*out)[point.dof[c]] = point.normal[c];
  }
}

/// Fills the named outputs that the script asked for.
void write_outputs(Stack stack, const Arguments& args, const Scene& scene,
                   const Solution& solution) {
  if (double* out = args.output<double>(stack, p_residual)) *out = solution.certificate.residual;
  if (long* out = args.output<long>(stack, p_iterations)) *out = solution.iterations;
  if (KN<double>* out = args.output<KN<double>>(stack, p_force)) {
    const Vector force = scene.system->force_to_global(solution.certificate.r);
    out->resize(scene.ndof);
    for (long i = 0; i < scene.ndof; ++i) (*out)[i] = force[i];
  }
  if (KN<long>* out = args.output<KN<long>>(stack, p_state)) {
    out->resize(scene.ndof);
    *out = 0L;
    for (Index k = 0; k < scene.system->nodes(); ++k)
      for (int c = 0; c < scene.d; ++c)
        (*out)[scene.nodes[scene.system->node(k).point].point.dof[c]] =
            static_cast<long>(solution.state[k]);
  }
  if (KN<double>* out = args.output<KN<double>>(stack, p_normals)) write_normals(scene, out);
}

/// One increment: the load b, and what the arguments say, on a posed scene.
KN_<double> solve_scene(Stack stack, const Arguments& args, Scene& scene, const KN_<double>& load) {
  const double start = cpu_seconds();
  const Settings s = args.settings(stack);
  const Vector b = checked_vector(load, "b", scene.ndof);
  Vector u_old, u_init;
  if (args.has(p_uold))
    u_old = checked_vector(args.value<KN_<double>>(stack, p_uold, KN_<double>(load)), "uold",
                           scene.ndof);
  if (args.has(p_init))
    u_init = checked_vector(args.value<KN_<double>>(stack, p_init, KN_<double>(load)), "init",
                            scene.ndof);
  const LocalSystem& system = *scene.system;
  const LocalIncrement now = scene.increment(b, u_old);
  const ContactProblem problem{system.system(), now.increment};

  const long verb = args.value<long>(stack, p_verb, std::min(verbosity, 1L));
  if (verb > 0) report_plan(args, scene, problem, s);
  History history(problem);
  KNM<double>* history_out = args.output<KNM<double>>(stack, p_history);
  Vector x0;
  if (u_init.size() > 0) x0 = system.to_local(u_old.size() == 0 ? u_init : Vector(u_init - u_old));
  const Solution solution =
      scene.solver->solve(now.increment, s, x0, history_out ? &history : nullptr);

  const StatusText text = describe(solution.status);
  if (verb > 0) {
    std::cout << " -- " << operator_name << ": " << text.name
              << (solution.route == Route::condensed ? " by the condensed route"
                                                     : " by iterations on A")
              << ", residual " << solution.certificate.residual << ", " << solution.iterations
              << " iterations";
    if (solution.passes > 0) std::cout << " in " << solution.passes << " passes of the fixed point";
    if (solution.eps > 0) std::cout << ", regeps " << solution.eps;
    std::cout << std::endl;
  }
  long* status_out = args.output<long>(stack, p_status);
  if (solution.status != Status::converged && !status_out) {
    std::ostringstream m;
    m << "not converged (" << text.name << ") after " << solution.iterations
      << " iterations: residual " << solution.certificate.residual << ", tol " << s.tol << "; "
      << text.remedy << "; pass status=... to get the field all the same";
    throw IllegalInput(m.str());
  }
  if (status_out) *status_out = static_cast<long>(solution.status);
  write_outputs(stack, args, scene, solution);
  if (history_out) history.write(history_out);

  KN<double>* u = Add2StackOfPtr2Free(stack, new KN<double>(scene.ndof));
  const Vector field = system.to_global(solution.x, now.u0);
  for (long i = 0; i < scene.ndof; ++i) (*u)[i] = field[i];
  if (KN<double>* out = args.output<KN<double>>(stack, p_times)) {
    const Times& t = solution.times;
    out->resize(8);
    const double phases[] = {scene.copy_seconds, t.order,
                             t.factor,           t.condense,
                             t.contact,          t.back_substitution,
                             t.certificate,      scene.copy_seconds + cpu_seconds() - start};
    for (int k = 0; k < 8; ++k) (*out)[k] = phases[k];
  }
  scene.copy_seconds = 0;  // further increments do not copy
  return *u;
}

/// u[] = frictionalContactCG(A, b, Vh, labels, ...), for V = v_fes (2D) or v_fes3 (3D).
template <class V, class L>
class SolveOnce : public E_F0mps {
 public:
  using Result = KN_<double>;
  explicit SolveOnce(const basicAC_F0& args)
      : arguments_(args, Dimension<typename V::FESpace>::d, true),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        b_(to<KN_<double>>(args[1])),
        Vh_(to<typename V::pfes*>(args[2])),
        labels_(args[3]) {}
  static ArrayOfaType typeargs() {
    return ArrayOfaType(atype<Matrice_Creuse<double>*>(), atype<KN_<double>>(),
                        atype<typename V::pfes*>(), atype<L>());
  }
  static E_F0* f(const basicAC_F0& args) { return new SolveOnce(args); }
  AnyType operator()(Stack stack) const override {
    return translated(operator_name, [&] {
      const auto scene = pose<V>(stack, arguments_, GetAny<Matrice_Creuse<double>*>((*A_)(stack)),
                                 GetAny<typename V::pfes*>((*Vh_)(stack)), labels_(stack), false);
      return SetAny<KN_<double>>(
          solve_scene(stack, arguments_, *scene, GetAny<KN_<double>>((*b_)(stack))));
    });
  }

 private:
  Arguments arguments_;
  Expression A_, b_, Vh_;
  Labels<L> labels_;
};

/// What a script's variable of type contactproblem holds.
class ContactProblemVariable {
 public:
  void init() { scene_ = new std::shared_ptr<Scene>; }
  void destroy() {
    delete scene_;
    scene_ = nullptr;
  }
  std::shared_ptr<Scene>& scene() { return *scene_; }

 private:
  std::shared_ptr<Scene>* scene_ = nullptr;  // FreeFEM copies the bytes of its variables
};

/// contactproblem C = contactProblem(A, Vh, labels, ...): FreeFEM's grammar takes no fespace in
/// C(A, Vh, ...).
template <class V, class L>
class Construct : public E_F0mps {
 public:
  using Result = ContactProblemVariable*;
  explicit Construct(const basicAC_F0& args)
      : arguments_(args, Dimension<typename V::FESpace>::d, true),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        Vh_(to<typename V::pfes*>(args[1])),
        labels_(args[2]) {
    for (int p = 0; p < parameter_count; ++p)
      if (arguments_.has(Parameter(p)) && p != p_mu && p != p_mu2 && p != p_direction &&
          p != p_gap && p != p_normal && p != p_slidinglimit && p != p_bilateral)
        CompileError(std::string(constructor_name) + ": " + parameters[p].name +
                     " belongs to frictionalContactCG(C, b, ...)");
  }
  static ArrayOfaType typeargs() {
    return ArrayOfaType(atype<Matrice_Creuse<double>*>(), atype<typename V::pfes*>(), atype<L>());
  }
  static E_F0* f(const basicAC_F0& args) { return new Construct(args); }
  AnyType operator()(Stack stack) const override {
    return translated(constructor_name, [&] {
      auto* C = new ContactProblemVariable;
      C->init();
      Add2StackOfPtr2Free(stack, new Owner{C});
      C->scene() = pose<V>(stack, arguments_, GetAny<Matrice_Creuse<double>*>((*A_)(stack)),
                           GetAny<typename V::pfes*>((*Vh_)(stack)), labels_(stack), true);
      return SetAny<ContactProblemVariable*>(C);
    });
  }

 private:
  /// Ends the temporary at the end of the statement; variables share its scene.
  struct Owner {
    ContactProblemVariable* C;
    ~Owner() {
      C->destroy();
      delete C;
    }
  };
  Arguments arguments_;
  Expression A_, Vh_;
  Labels<L> labels_;
};

ContactProblemVariable* first_assignment(ContactProblemVariable* C, ContactProblemVariable* from) {
  C->init();
  C->scene() = from->scene();
  return C;
}

ContactProblemVariable* assignment(ContactProblemVariable* C, ContactProblemVariable* from) {
  C->scene() = from->scene();
  return C;
}

/// u[] = frictionalContactCG(C, b, ...)
class SolveIncrement : public E_F0mps {
 public:
  using Result = KN_<double>;
  explicit SolveIncrement(const basicAC_F0& args)
      : arguments_(args, 0, false),
        C_(to<ContactProblemVariable*>(args[0])),
        b_(to<KN_<double>>(args[1])) {}
  static ArrayOfaType typeargs() {
    return ArrayOfaType(atype<ContactProblemVariable*>(), atype<KN_<double>>());
  }
  static E_F0* f(const basicAC_F0& args) { return new SolveIncrement(args); }
  AnyType operator()(Stack stack) const override {
    return translated(operator_name, [&] {
      Scene* scene = GetAny<ContactProblemVariable*>((*C_)(stack))->scene().get();
      if (!scene)
        throw IllegalInput(
            "C is not set; write contactproblem C = contactProblem(A, Vh, labels, ...)");
      if (scene->law == Law::frictionless &&
          (arguments_.has(p_mu) || arguments_.has(p_slidinglimit)))
        throw IllegalInput(
            "C was made without friction; name mu or slidinglimit in contactProblem(...), too");
      set_laws(stack, arguments_, *scene);
      return SetAny<KN_<double>>(
          solve_scene(stack, arguments_, *scene, GetAny<KN_<double>>((*b_)(stack))));
    });
  }

 private:
  Arguments arguments_;
  Expression C_, b_;
};

template <class V, class L>
void register_labels() {
  Global.Add(operator_name, "(", new OneOperatorCode<SolveOnce<V, L>>());
  Global.Add(constructor_name, "(", new OneOperatorCode<Construct<V, L>>());
}

template <class V>
void register_dimension() {
  register_labels<V, long>();
  register_labels<V, KN_<long>>();
  register_labels<V, E_Array>();
}

AnyType init_variable(Stack, const AnyType& x) {
  GetAny<ContactProblemVariable*>(x)->init();
  return x;
}

void load() {
  const double compiled = std::strtod(FREEFEM_VERSION, nullptr);
  if (std::abs(VersionNumber() - compiled) > 1e-6) {
    std::ostringstream m;
    m << "frictionCG was built for FreeFEM " << FREEFEM_VERSION << " but runs in "
      << VersionNumber() << "; rebuild it with `make`";
    throw ErrorLoad(m.str().c_str(), 1);
  }
  Dcl_Type<ContactProblemVariable*>(init_variable, ::Destroy<ContactProblemVariable>);
  zzzfff->Add("contactproblem", atype<ContactProblemVariable*>());
  using C = ContactProblemVariable*;
  TheOperators->Add("<-", new OneOperator2<C, C, C>(first_assignment));
  TheOperators->Add("=", new OneOperator2<C, C, C>(assignment));
  register_dimension<v_fes>();
  register_dimension<v_fes3>();
  Global.Add(operator_name, "(", new OneOperatorCode<SolveIncrement>());
}

}  // namespace

LOADFUNC(load)
