#pragma once
#include "freefem.h"

#include <cmath>

#include "scene.h"

namespace frictioncg {

constexpr const char* operator_name = "frictionalContactCG";

enum Parameter {
  p_mu,
  p_mu2,
  p_direction,
  p_gap,
  p_normal,
  p_slidinglimit,
  p_bilateral,
  p_uold,
  p_init,
  p_method,
  p_polish,
  p_reg,
  p_regeps,
  p_precon,
  p_omega,
  p_step,
  p_tol,
  p_nbiter,
  p_memory,
  p_verb,
  p_status,
  p_residual,
  p_iterations,
  p_force,
  p_state,
  p_normals,
  p_history,
  p_times,
  parameter_count
};

inline basicAC_F0::name_and_type parameters[] = {
    {"mu", &typeid(double)},             // friction coefficient
    {"mu2", &typeid(double)},            // across direction, mu being along it
    {"direction", &typeid(E_Array)},     // of orthotropic friction
    {"gap", &typeid(double)},            // [length]
    {"normal", &typeid(E_Array)},        // outward from the body
    {"slidinglimit", &typeid(double)},   // [force/area]
    {"bilateral", &typeid(bool)},        // no separation
    {"uold", &typeid(KN_<double>)},      // [length]
    {"init", &typeid(KN_<double>)},      // [length]
    {"method", &typeid(string*)},        //
    {"polish", &typeid(bool)},           //
    {"reg", &typeid(string*)},           //
    {"regeps", &typeid(double)},         // [length]
    {"precon", &typeid(string*)},        //
    {"omega", &typeid(double)},          //
    {"step", &typeid(string*)},          //
    {"tol", &typeid(double)},            //
    {"nbiter", &typeid(long)},           //
    {"memory", &typeid(double)},         // [GB]
    {"verb", &typeid(long)},             //
    {"status", &typeid(long*)},          // out
    {"residual", &typeid(double*)},      // out
    {"iterations", &typeid(long*)},      // out
    {"force", &typeid(KN<double>*)},     // out [force]
    {"state", &typeid(KN<long>*)},       // out
    {"normals", &typeid(KN<double>*)},   // out
    {"history", &typeid(KNM<double>*)},  // out
    {"times", &typeid(KN<double>*)},     // out [s]
};
static_assert(sizeof(parameters) / sizeof(*parameters) == parameter_count, "one name each");

/// A table of the values that a string parameter may take.
template <class T>
struct Choice {
  const char* name;
  T value;
};
constexpr Choice<Method> methods[] = {{"auto", Method::automatic}, {"condensed", Method::condensed},
                                      {"GC3", Method::gc3},        {"GC2", Method::gc2},
                                      {"GC1", Method::gc1},        {"GCX", Method::gcx},
                                      {"SORP", Method::sorp}};
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

/// The named parameters of one call, as expressions.
class Arguments {
 public:
  Arguments(const basicAC_F0& args, int d, bool geometry) : d_(d) {
    args.SetNameParam(parameter_count, parameters, named_);
    for (Parameter p : {p_normal, p_mu2, p_direction})
      if (has(p) && !geometry) refuse(p, "belongs to the contactproblem; give it there");
    if (has(p_normal)) components(p_normal, "[nx, ny, nz]", "[nx, ny]", normal_);
    if (!has(p_mu2) && !has(p_direction)) return;
    if (d == 2)
      refuse(p_mu2, "is friction across a direction of the contact plane; in 2D there is mu alone");
    if (!has(p_mu) || !has(p_mu2) || !has(p_direction))
      refuse(p_mu2, "goes with mu and direction: mu along the direction, mu2 across it");
    components(p_direction, "[dx, dy, dz]", "", direction_);
  }

  bool has(Parameter p) const { return named_[p] != nullptr; }

  template <class T>
  T value(Stack stack, Parameter p, T otherwise) const {
    return has(p) ? GetAny<T>((*named_[p])(stack)) : otherwise;
  }
  template <class T>
  T* output(Stack stack, Parameter p) const {
    return value<T*>(stack, p, nullptr);
  }

  /// One clear sentence each for what the settings may not be.
  Settings settings(Stack stack) const;

  /// mu, gap or slidinglimit at each contact node.
  Vector at_nodes(Stack stack, Parameter p, const Scene& scene) const;

  void set_normals(Stack stack, Scene& scene) const;

  /// Orthotropic friction: the ratio of the coefficients, and the direction of the first.
  void set_orthotropy(Stack stack, Scene& scene) const;

 private:
  using Components = std::array<Expression, 3>;
  using Vector3 = std::array<double, 3>;

  static void refuse(Parameter p, const char* rule) {
    CompileError(std::string(operator_name) + ": " + parameters[p].name + " " + rule);
  }
  /// The expressions of a parameter that is a vector.
  void components(Parameter p, const char* in_3d, const char* in_2d, Components& out) const {
    const E_Array* list = dynamic_cast<const E_Array*>(named_[p]);
    if (!list || list->size() != d_)
      refuse(p, (std::string("= ") + (d_ == 2 ? in_2d : in_3d) + " on a " + (d_ == 2 ? "2" : "3") +
                 "D mesh")
                    .c_str());
    for (int c = 0; c < d_; ++c) out[c] = to<double>((*list)[c]);
  }
  /// Their values at the present point, scaled to length 1; false where they have no direction.
  bool unit_vector(Stack stack, const Components& components, Vector3& n) const {
    double norm = 0;
    for (int c = 0; c < d_; ++c) {
      n[c] = GetAny<double>((*components[c])(stack));
      norm = std::hypot(norm, n[c]);
    }
    for (int c = 0; c < d_; ++c) n[c] /= norm;
    return norm > 0 && std::isfinite(norm);
  }
  template <class T, std::size_t count>
  T chosen(Stack stack, Parameter p, const Choice<T> (&choices)[count], T otherwise) const {
    return has(p) ? choose(parameters[p].name, *value<string*>(stack, p, nullptr), choices)
                  : otherwise;
  }

  int d_;
  Expression named_[parameter_count];
  Components normal_{}, direction_{};
};

/// Saves where expressions are evaluated, and restores it, whatever happens between.
class PointGuard {
 public:
  explicit PointGuard(Stack stack) : point_(MeshPointStack(stack)), saved_(*point_) {}
  ~PointGuard() { *point_ = saved_; }
  PointGuard(const PointGuard&) = delete;
  PointGuard& operator=(const PointGuard&) = delete;
  MeshPoint* point() { return point_; }

 private:
  MeshPoint* point_;
  MeshPoint saved_;
};

inline Settings Arguments::settings(Stack stack) const {
  Settings s;
  s.method = chosen(stack, p_method, methods, s.method);
  s.reg = chosen(stack, p_reg, regularizations, s.reg);
  s.precon = chosen(stack, p_precon, preconditioners, s.precon);
  s.step = chosen(stack, p_step, steps, s.step);
  s.polish = value(stack, p_polish, s.polish);
  s.regeps = value(stack, p_regeps, s.regeps);
  s.omega = value(stack, p_omega, s.omega);
  s.tol = value(stack, p_tol, s.tol);
  s.nbiter = static_cast<Index>(value<long>(stack, p_nbiter, s.nbiter));
  s.memory = 1e9 * value(stack, p_memory, s.memory / 1e9);
  const auto require = [&](bool holds, Parameter p, double x, const char* rule) {
    if (holds) return;
    std::ostringstream m;
    m << parameters[p].name << " = " << x << "; " << rule;
    throw IllegalInput(m.str());
  };
  require(!has(p_regeps) || (s.regeps > 0 && std::isfinite(s.regeps)), p_regeps, s.regeps,
          "the regularization is a length > 0; leave it out to scale it from the scene");
  require(!has(p_omega) || (s.omega > 0 && s.omega < 2), p_omega, s.omega,
          "a relaxation parameter lies between 0 and 2");
  require(s.tol > 0 && s.tol < 1, p_tol, s.tol, "the tolerance lies between 0 and 1");
  require(!has(p_nbiter) || s.nbiter > 0, p_nbiter, s.nbiter,
          "the bound on the iterations is >= 1");
  require(s.memory > 0, p_memory, s.memory / 1e9, "the memory bound is a number of GB > 0");

  const bool direct = s.method == Method::automatic || s.method == Method::condensed;
  for (Parameter p : {p_reg, p_regeps, p_precon, p_omega, p_step}) {
    if (!has(p)) continue;
    const std::string name = parameters[p].name;
    if (direct && s.polish)
      throw IllegalInput(name + " has no meaning with method=\"" + name_of(s.method, methods) +
                         "\", whose answer is not regularized; add method=\"GC3\" or polish=false");
    if (s.method == Method::gcx && (p == p_reg || p == p_regeps))
      throw IllegalInput(name +
                         " has no meaning with method=\"GCX\", which does not regularize; leave "
                         "it out");
    if (s.method == Method::sorp && p != p_omega)
      throw IllegalInput(name +
                         " has no meaning with method=\"SORP\", which neither regularizes nor "
                         "preconditions; leave it out");
  }
  if (has(p_polish) && !direct)
    throw IllegalInput(std::string("polish has no meaning with method=\"") +
                       name_of(s.method, methods) + "\"; leave it out, or the method");
  return s;
}

inline Vector Arguments::at_nodes(Stack stack, Parameter p, const Scene& scene) const {
  Vector result = Vector::Zero(static_cast<Index>(scene.nodes.size()));
  if (!has(p)) return result;
  PointGuard guard(stack);
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    scene.go_to(guard.point(), scene.nodes[k]);
    const double x = GetAny<double>((*named_[p])(stack));
    if (!std::isfinite(x) || (p != p_gap && x < 0)) {
      std::ostringstream m;
      m << parameters[p].name << " = " << x << " at " << place(scene.nodes[k], d_) << "; "
        << (p == p_mu || p == p_mu2 ? "a friction coefficient is a number >= 0"
            : p == p_gap            ? "a gap is a finite length"
                                    : "a sliding limit is a traction >= 0");
      throw IllegalInput(m.str());
    }
    result[k] = x;
  }
  return result;
}

inline void Arguments::set_normals(Stack stack, Scene& scene) const {
  if (!has(p_normal)) return;
  PointGuard guard(stack);
  for (BoundaryNode& node : scene.nodes) {
    scene.go_to(guard.point(), node);
    Vector3 n{};
    if (!unit_vector(stack, normal_, n))
      throw IllegalInput("normal has no direction at " + place(node, d_) +
                         "; give the outward normal of the body, of any length > 0");
    node.point.normal = n;
  }
}

inline void Arguments::set_orthotropy(Stack stack, Scene& scene) const {
  if (!has(p_mu2)) return;
  const Vector mu2 = at_nodes(stack, p_mu2, scene);
  PointGuard guard(stack);
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    BoundaryNode& node = scene.nodes[k];
    if ((scene.mu[k] > 0) != (mu2[k] > 0)) {
      std::ostringstream m;
      m << "mu = " << scene.mu[k] << " but mu2 = " << mu2[k] << " at " << place(node, d_)
        << "; both coefficients are > 0, or both are 0";
      throw IllegalInput(m.str());
    }
    if (scene.mu[k] == 0) continue;
    ContactPoint& p = node.point;
    scene.go_to(guard.point(), node);
    double along_normal = 0;
    const bool has_direction = unit_vector(stack, direction_, p.direction);
    for (int c = 0; c < d_; ++c) along_normal += p.direction[c] * p.normal[c];
    if (!has_direction || std::abs(along_normal) > 1 - 1e-10)
      throw IllegalInput("direction has no part in the contact plane at " + place(node, d_) +
                         "; give a direction, of any length > 0, that is not the normal");
    p.across = mu2[k] / scene.mu[k];
  }
}

}  // namespace frictioncg
