#pragma once
#include "freefem.h"

#include "errors.h"
#include "labels.h"
#include "parameters.h"

namespace frictioncg {

/// The named parameters of one call, as expressions: what a script wrote, not yet evaluated.
class Arguments {
 public:
  using Components = std::array<Expression, 3>;

  /// Of a call that poses a problem of dimension d, normals and directions included.
  Arguments(const basicAC_F0& args, int d, bool two_bodies) : Arguments(args) {
    for (Parameter p : {p_maxgap, p_smooth, p_distance})
      if (!two_bodies && has(p))
        refuse(p,
               "belongs to contact of two bodies; name slave and master, as in "
               "frictionalContactCG(A, b, Vh, slave, master, ...)");
    for (Parameter p : of_obstacle_beside_pairs)
      if (!two_bodies && has(p))
        refuse(p,
               "belongs to an obstacle beside pairs of bodies; with one body the labels after Vh "
               "touch it, and gap, normal and force are its own");
    for (Parameter p : of_obstacle_beside_pairs)
      if (has(p) && !has(p_obstacle)) refuse(p, "needs the labels that touch it, as in obstacle=1");
    for (Parameter p : of_moving_obstacle)
      if (two_bodies && has(p))
        refuse(p,
               "belongs to one body and an obstacle; of two bodies each moves by its own "
               "displacement");
    refuse_force_of_nowhere();
    if (has(p_pivot)) components(p_pivot, d, "[x, y, z]", "[x, y]", vectors_[p_pivot]);
    for (Parameter p : {p_normal, p_obstaclenormal})
      if (has(p)) components(p, d, "[nx, ny, nz]", "[nx, ny]", vectors_[p]);
    if (!has(p_mu2) && !has(p_direction)) return;
    const Parameter given = has(p_mu2) ? p_mu2 : p_direction;
    if (d == 2)
      refuse(given, "belongs to orthotropic friction in a contact plane; in 2D there is mu alone");
    if (!has(p_mu) || !has(p_mu2) || !has(p_direction))
      refuse(given, "is one of three that go together: mu along direction, and mu2 across it");
    components(p_direction, d, "[dx, dy, dz]", "", vectors_[p_direction]);
  }

  /// Of a call on a contactproblem, whose geometry stands.
  static Arguments of_increment(const basicAC_F0& args) {
    const Arguments a = of_contactproblem(args);
    for (Parameter p : of_geometry)
      if (a.has(p))
        refuse(p,
               "belongs to the contactproblem; give it there, or with a new matrix, as in "
               "frictionalContactCG(C, A, b, ...)");
    return a;
  }
  /// The same with a new matrix, which may bring new normals along.
  static Arguments of_renewal(const basicAC_F0& args) {
    Arguments a = of_contactproblem(args, true);
    for (Parameter p : {p_normal, p_obstaclenormal})
      if (const auto* list = dynamic_cast<const E_Array*>(a.named_[p]))
        a.components(p, list->size() == 2 ? 2 : 3, "[nx, ny, nz]", "[nx, ny]", a.vectors_[p]);
    return a;
  }

  /// A parameter of the constructor's that is not among `allowed` is refused.
  void allow_only(std::initializer_list<Parameter> allowed) const {
    for (int p = 0; p < parameter_count; ++p)
      if (has(Parameter(p)) && std::find(allowed.begin(), allowed.end(), p) == allowed.end())
        CompileError(std::string(constructor_name) + ": " + parameters[p].name +
                     " belongs to frictionalContactCG(C, b, ...)");
  }

  bool has(Parameter p) const { return named_[p] != nullptr; }
  /// Whether one of several is there.
  template <std::size_t count>
  bool has_any(const Parameter (&of)[count]) const {
    return std::any_of(of, of + count, [this](Parameter p) { return has(p); });
  }
  Parameter start() const { return has(p_start) ? p_start : p_init; }
  /// Of normal, obstaclenormal or direction.
  const Components& vector(Parameter p) const { return vectors_[p]; }
  /// The labels of an obstacle beside pairs; none where there is none.
  std::vector<long> obstacle(Stack stack) const {
    return obstacle_ ? (*obstacle_)(stack, parameters[p_obstacle].name) : std::vector<long>();
  }

  /// Of a parameter that is there.
  template <class T>
  T value(Stack stack, Parameter p) const {
    return evaluated(parameters[p].name, [&] { return GetAny<T>((*named_[p])(stack)); });
  }
  template <class T>
  T value(Stack stack, Parameter p, T otherwise) const {
    return has(p) ? value<T>(stack, p) : otherwise;
  }
  template <class T>
  T* output(Stack stack, Parameter p) const {
    return value<T*>(stack, p, nullptr);
  }
  template <class T, std::size_t count>
  T chosen(Stack stack, Parameter p, const Choice<T> (&choices)[count], T otherwise) const {
    return has(p) ? choose(parameters[p].name, *value<string*>(stack, p, nullptr), choices)
                  : otherwise;
  }

 private:
  static Arguments of_contactproblem(const basicAC_F0& args, bool renewed = false) {
    const Arguments a(args);
    for (Parameter p :
         {p_mu2, p_direction, p_domain, p_obstacle, p_pivot, p_obstacles, p_motionfree})
      if (a.has(p)) refuse(p, "belongs to the contactproblem; give it there");
    for (Parameter p : {p_at, p_forceold})
      if (!renewed && a.has(p))
        refuse(p,
               "belongs to the contactproblem; give it there, or with another matrix, as in "
               "frictionalContactCG(C, A, b, at=U)");
    a.refuse_force_of_nowhere();
    return a;
  }
  void refuse_force_of_nowhere() const {
    if (has(p_forceold) && !has(p_at))
      refuse(p_forceold, "is a force that turns with the geometry at X + U; name that, as in at=U");
  }
  explicit Arguments(const basicAC_F0& args) {
    refuse_domain(args);
    read_names(args);
    if (has(p_init) && has(p_start)) refuse(p_start, "is another name of init; give one");
  }
  /// A named parameter has one type for FreeFEM, and labels have three forms: while the others are
  /// read, obstacle is not among them.
  void read_names(const basicAC_F0& args) {
    const char* const name = parameters[p_obstacle].name;
    const C_F0 labels = args.find(name);
    const bool given = labels.LeftValue() != nullptr;
    if (given) args.named_parameter->erase(name);
    args.SetNameParam(parameter_count, parameters, named_);
    if (!given) return;
    args.named_parameter->emplace(name, labels);
    named_[p_obstacle] = labels.LeftValue();
    obstacle_.emplace(labels);
  }
  /// Before FreeFEM looks for the type of domain, which frictionCG-mpi alone has.
  static void refuse_domain(const basicAC_F0& args) {
    const bool known = *parameters[p_domain].type != typeid(void);
    if (!known && args.find(parameters[p_domain].name).LeftValue())
      refuse(p_domain,
             "belongs to a problem that several processes share, which frictionCG has none of; "
             "load \"frictionCG-mpi\" in its place, or leave domain out");
  }
  static void refuse(Parameter p, const std::string& rule) {
    CompileError(std::string(operator_name) + ": " + parameters[p].name + " " + rule);
  }
  /// The expressions of a parameter that is a vector.
  void components(Parameter p, int d, const char* in_3d, const char* in_2d, Components& out) const {
    const E_Array* list = dynamic_cast<const E_Array*>(named_[p]);
    if (!list || list->size() != d)
      refuse(p, std::string("= ") + (d == 2 ? in_2d : in_3d) + " on a " + (d == 2 ? "2" : "3") +
                    "D mesh");
    for (int c = 0; c < d; ++c) out[c] = to<double>((*list)[c]);
  }

  Expression named_[parameter_count];
  Components vectors_[parameter_count]{};
  std::optional<Labels> obstacle_;
};

}  // namespace frictioncg
