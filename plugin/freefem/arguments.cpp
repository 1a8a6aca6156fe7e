#include "freefem.h"

#include "arguments.h"

#include "../core/model/validate.h"

namespace frictioncg {

namespace {

/// FreeFEM's types of the named parameters.
basicAC_F0::name_and_type parameters[] = {
#define FRICTIONCG_ROW(name, type) {#name, &typeid(type)},
    FRICTIONCG_PARAMETERS(FRICTIONCG_ROW)
#undef FRICTIONCG_ROW
};

std::vector<long> copy_of(const KN_<long>& v) {
  std::vector<long> copy;
  for (long k = 0; k < v.N(); ++k) copy.push_back(v[k]);
  return copy;
}

/// Refuses the blocks of two bodies that come in the other order: nothing else would tell, where
/// the sizes add up. Couplings that the script has put between the bodies are none of it.
void refuse_other_order(const Triplets& A, const DofCount& dofs) {
  const long second = dofs.count - dofs.first;
  bool crosses_first = false, crosses_second = false;
  for_each_entry(A, [&](Index i, Index j, Real) {
    crosses_first = crosses_first || (i < dofs.first) != (j < dofs.first);
    crosses_second = crosses_second || (i < second) != (j < second);
  });
  if (crosses_first && !crosses_second) refuse_order(dofs);
}

/// Before a script runs.
void forbid(Parameter p, const std::string& rule) {
  CompileError(std::string(operator_name) + ": " + name_of(p) + " " + rule);
}

/// Those of several that are there.
void forbid(const Arguments& args, std::initializer_list<Parameter> of, const char* rule) {
  for (Parameter p : of)
    if (args.has(p)) forbid(p, rule);
}

/// Of a part of an array FreeFEM hands over a copy: what is written to it would be lost.
void forbid_parts(const basicAC_F0& args) {
  for (int p = 0; p < parameter_count; ++p) {
    const std::type_info& type = *parameters[p].type;
    const C_F0 given = args.find(parameters[p].name);
    if (!given.LeftValue()) continue;
    if ((type == typeid(KN<double>*) && given.left() == atype<KN_<double>>()) ||
        (type == typeid(KN<long>*) && given.left() == atype<KN_<long>>()))
      forbid(Parameter(p),
             "is a part of an array, and what is written to it would be lost; give a whole array, "
             "and take the part afterwards");
  }
}

/// Throws IllegalInput unless the rule holds for x, the value of the option p.
void require(bool holds, Parameter p, double x, const char* rule) {
  if (holds) return;
  refuse(name_of(p), " = ", x, "; ", rule);
}

/// The value of a table that a string names.
template <class T, std::size_t count>
T choose(Stack stack, const Arguments& args, Parameter p, const Choice<T> (&choices)[count],
         T otherwise) {
  if (!args.has(p)) return otherwise;
  const std::string value = *args.value<std::string*>(stack, p);
  std::string known;
  for (const Choice<T>& c : choices) {
    if (value == c.name) return c.value;
    known += std::string(known.empty() ? "\"" : ", \"") + c.name + "\"";
  }
  refuse(name_of(p), " = \"", value, "\" is unknown; choose from ", known);
}

/// A bound on the iterations: a whole number that fits, whatever a script writes.
Index bound_on_iterations(double nbiter) {
  require(nbiter >= 1, p_nbiter, nbiter,
          "the bound on the iterations is >= 1 (FreeFEM's whole numbers end at 2^31: write 1e10)");
  require(nbiter == std::floor(nbiter), p_nbiter, nbiter,
          "the bound on the iterations is a whole number");
  return static_cast<Index>(
      std::min<double>(nbiter, std::numeric_limits<Index>::max() / 2));  // sums of bounds fit
}

void refuse_force_of_nowhere(const Arguments& args) {
  if (args.has(p_forceold) && !args.has(p_at))
    forbid(p_forceold, "is a force that turns with the geometry at X + U; name that, as in at=U");
}

/// One label: FreeFEM would cast a real or a bool to a label that nobody has meant.
std::function<long(Stack, const char*)> label_of(const C_F0& given) {
  const aType type = given.left();
  const bool real = type == atype<double>() || type == atype<double*>();
  const bool boolean = type == atype<bool>() || type == atype<bool*>();
  const Expression e = real ? to<double>(given) : boolean ? to<bool>(given) : to<long>(given);
  return [=](Stack stack, const char* what) {
    constexpr const char* rule =
        "; a label is a whole number, as in 1, [1, 2] or an int[int], and all that is no label is "
        "given by name, as in mu=0.3";
    const AnyType value = (*e)(stack);
    if (real) refuse(what, " has the real ", GetAny<double>(value), rule);
    if (boolean) refuse(what, " has the bool ", GetAny<bool>(value) ? "true" : "false", rule);
    return GetAny<long>(value);
  };
}

Labels labels_of(const C_F0& argument) {
  const aType type = argument.left();
  std::vector<std::function<long(Stack, const char*)>> labels;
  Expression array = nullptr;  // in place of single ones
  if (const auto* list = dynamic_cast<const E_Array*>(argument.LeftValue())) {
    for (int k = 0; k < list->size(); ++k) labels.push_back(label_of((*list)[k]));
  } else if (type == atype<KN_<long>>() || type == atype<KN<long>*>()) {
    array = to<KN_<long>>(argument);
  } else {
    labels.push_back(label_of(argument));
  }
  return [=](Stack stack, const char* what) {
    std::vector<long> all;
    evaluated(what, [&] {
      if (array) all = copy_of(GetAny<KN_<long>>((*array)(stack)));
      for (const auto& label : labels) all.push_back(label(stack, what));
    });
    if (all.empty()) refuse(what, " is empty; name the boundary that may touch");
    return all;
  };
}

/// An option without effect is refused: it would let the user believe in what does not happen. The
/// core sees values alone; here what is given counts, be it the default.
void refuse_without_effect(const Arguments& args, const Settings& s) {
  constexpr std::pair<Parameter, Option> options[] = {
      {p_reg, Option::reg},       {p_regeps, Option::regeps},  {p_precon, Option::precon},
      {p_omega, Option::omega},   {p_step, Option::step},      {p_newton, Option::newton},
      {p_memory, Option::memory}, {p_threads, Option::threads}};
  for (const auto& [p, option] : options) {
    const char* const because = args.has(p) ? without_effect(option, s) : nullptr;
    if (!because) continue;
    const bool of_precon = p == p_omega && !takes_newton_steps(s);
    refuse(name_of(p), " has no meaning with ",
           (of_precon ? std::string("precon=\"") + name_of(s.precon, preconditioners)
                      : std::string("method=\"") + name_of(s.method, methods)),
           "\"", because);
  }
}

}  // namespace

const char* name_of(Parameter p) { return parameters[p].name; }

std::string DofCount::in_words() const {
  if (first == 0) return "Vh has " + std::to_string(count) + " degrees of freedom";
  return "V1 and V2 have " + std::to_string(first) + " + " + std::to_string(count - first) +
         " degrees of freedom";
}

void refuse_order(const DofCount& dofs) {
  throw IllegalInput("the blocks of A are in the other order: " + dofs.in_words() +
                     ", and A = [[A1, 0], [0, A2]] and b = [b1, b2] have those of V1, the space of "
                     "the slave, first");
}

void check_vector(const Vector& v, const char* name, const DofCount& dofs) {
  if (v.size() == 0 && dofs.count > 0)
    refuse(name, " has 0 entries but ", dofs.in_words(),
           "; FreeFEM assigns nothing to a real[int] without a size: declare it with its value");
  if (v.size() != dofs.count)
    refuse(name, " has ", v.size(), " entries but ", dofs.in_words(),
           "; was the mesh changed after ", name, " was computed?");
  for (long i = 0; i < v.size(); ++i) {
    if (std::isfinite(v[i])) continue;
    refuse(name, "[", i, "] = ", v[i], "; the entries of ", name, " must be finite");
  }
}

Vector copy_of(const KN_<double>& v) {
  Vector copy(v.N());
  for (long i = 0; i < v.N(); ++i) copy[i] = v[i];
  return copy;
}

Vector copy_of(const KN<double>* v) {
  return v ? copy_of(static_cast<const KN_<double>&>(*v)) : Vector();
}

Vector vector_of(Stack stack, Expression expression, const char* name) {
  return evaluated(name, [&] { return copy_of(GetAny<KN_<double>>((*expression)(stack))); });
}

void write(const Vector& values, KN<double>* out) {
  if (!out) return;
  out->resize(values.size());
  for (long i = 0; i < out->N(); ++i) (*out)[i] = values[i];
}

void write(const std::vector<long>& values, KN<long>* out) {
  if (!out) return;
  out->resize(static_cast<long>(values.size()));
  std::copy(values.begin(), values.end(), static_cast<long*>(*out));
}

void write(const std::vector<std::array<double, 4>>& rows, KNM<double>* out) {
  if (!out) return;
  out->resize(static_cast<long>(rows.size()), 4);
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (int c = 0; c < 4; ++c) (*out)(static_cast<int>(k), c) = rows[k][c];
}

Triplets matrix_of(Stack stack, Expression expression, const DofCount& dofs) {
  return evaluated("A", [&] {
    Matrice_Creuse<double>* const A = GetAny<Matrice_Creuse<double>*>((*expression)(stack));
    HashMatrix<int, double>* H = A ? A->pHM() : nullptr;
    if (!H) throw IllegalInput("A is empty; assemble it first, as in matrix A = a(Vh, Vh)");
    if (H->n != dofs.count || H->m != dofs.count)
      refuse("A is ", H->n, " x ", H->m, " but ", dofs.in_words(),
             (dofs.first == 0 ? "; assemble A on the present Vh"
                              : "; give the matrix of both bodies, A = [[A1, 0], [0, A2]], and b = "
                                "[b1, b2], or name once a space that has both"));
    Triplets t;
    t.n = H->n;
    t.size = H->nnz;
    t.i = H->i;
    t.j = H->j;
    t.a = H->aij;
    t.base = H->fortran;
    t.half = H->half > 0;
    if (dofs.first > 0 && 2 * dofs.first != dofs.count) refuse_other_order(t, dofs);
    return t;
  });
}

Arguments::Arguments(const basicAC_F0& args, int d, bool two_bodies) : Arguments(args) {
  if (!two_bodies) {
    forbid(*this, {p_maxgap, p_smooth, p_distance},
           "belongs to contact of two bodies; name slave and master, as in "
           "frictionalContactCG(A, b, Vh, slave, master, ...)");
    forbid(*this, of_obstacle_beside_pairs,
           "belongs to an obstacle beside pairs of bodies; with one body the labels after Vh "
           "touch it, and gap, normal and force are its own");
  }
  if (!has(p_obstacle))
    forbid(*this, of_obstacle_beside_pairs, "needs the labels that touch it, as in obstacle=1");
  if (two_bodies)
    forbid(*this, of_moving_obstacle,
           "belongs to one body and an obstacle; of two bodies each moves by its own "
           "displacement");
  refuse_force_of_nowhere(*this);
  if (has(p_pivot)) components(p_pivot, d, "[x, y, z]", "[x, y]");
  for (Parameter p : {p_normal, p_obstaclenormal})
    if (has(p)) components(p, d, "[nx, ny, nz]", "[nx, ny]");
  if (!has(p_mu2) && !has(p_direction)) return;
  const Parameter given = has(p_mu2) ? p_mu2 : p_direction;
  if (d == 2)
    forbid(given, "belongs to orthotropic friction in a contact plane; in 2D there is mu alone");
  if (!has(p_mu) || !has(p_mu2) || !has(p_direction))
    forbid(given, "is one of three that go together: mu along direction, and mu2 across it");
  components(p_direction, d, "[dx, dy, dz]", "");
}

void Arguments::allow_only(std::initializer_list<Parameter> allowed) const {
  for (int p = 0; p < parameter_count; ++p)
    if (has(Parameter(p)) && std::find(allowed.begin(), allowed.end(), p) == allowed.end())
      CompileError(std::string(constructor_name) + ": " + name_of(Parameter(p)) +
                   " belongs to frictionalContactCG(C, b, ...)");
}

std::vector<long> Arguments::obstacle(Stack stack) const {
  return obstacle_ ? obstacle_(stack, name_of(p_obstacle)) : std::vector<long>();
}

template <class T>
T Arguments::value(Stack stack, Parameter p) const {
  return evaluated(name_of(p), [&] { return GetAny<T>((*named_[p])(stack)); });
}
template bool Arguments::value(Stack, Parameter) const;
template long Arguments::value(Stack, Parameter) const;
template double Arguments::value(Stack, Parameter) const;
template long* Arguments::value(Stack, Parameter) const;
template double* Arguments::value(Stack, Parameter) const;
template KN<long>* Arguments::value(Stack, Parameter) const;
template KN<double>* Arguments::value(Stack, Parameter) const;
template KNM<double>* Arguments::value(Stack, Parameter) const;

Vector Arguments::vector(Stack stack, Parameter p) const {
  return has(p) ? vector_of(stack, named_[p], name_of(p)) : Vector();
}

Vector Arguments::vector(Stack stack, Parameter p, const DofCount& dofs) const {
  const Vector v = vector(stack, p);
  if (has(p)) check_vector(v, name_of(p), dofs);
  return v;
}

std::vector<long> Arguments::integers(Stack stack, Parameter p) const {
  return has(p) ? copy_of(value<KN_<long>>(stack, p)) : std::vector<long>();
}

double Arguments::component(Stack stack, Parameter p, int c) const {
  return evaluated(name_of(p), [&] { return GetAny<double>((*vectors_[p][c])(stack)); });
}

Arguments Arguments::of_contactproblem(const basicAC_F0& args, bool renewed) {
  Arguments a(args);
  forbid(a, {p_mu2, p_direction, p_domain, p_obstacle, p_pivot, p_obstacles, p_motionfree},
         "belongs to the contactproblem; give it there");
  if (!renewed)
    forbid(a, of_geometry,
           "belongs to the contactproblem; give it there, or with a new matrix, as in "
           "frictionalContactCG(C, A, b, ...)");
  refuse_force_of_nowhere(a);
  for (Parameter p : {p_normal, p_obstaclenormal})
    if (const auto* list = dynamic_cast<const E_Array*>(a.named_[p]))
      a.components(p, list->size() == 2 ? 2 : 3, "[nx, ny, nz]", "[nx, ny]");
  return a;
}

Arguments::Arguments(const basicAC_F0& args) {
  forbid_parts(args);
  // before FreeFEM looks for the type of domain, which frictionCG-mpi alone has
  const bool known = *parameters[p_domain].type != typeid(void);
  if (!known && args.find(name_of(p_domain)).LeftValue())
    forbid(p_domain,
           "belongs to a problem that several processes share, which frictionCG has none of; "
           "load \"frictionCG-mpi\" in its place, or leave domain out");
  // a named parameter has one type for FreeFEM, and labels have three forms: while the others are
  // read, obstacle is not among them
  const char* const name = name_of(p_obstacle);
  const C_F0 labels = args.find(name);
  const bool given = labels.LeftValue() != nullptr;
  if (given) args.named_parameter->erase(name);
  args.SetNameParam(parameter_count, parameters, named_);
  if (given) {
    args.named_parameter->emplace(name, labels);
    named_[p_obstacle] = labels.LeftValue();
    obstacle_ = labels_of(labels);
  }
  if (has(p_init) && has(p_start)) forbid(p_start, "is another name of init; give one");
}

/// The expressions of a parameter that is a vector.
void Arguments::components(Parameter p, int d, const char* in_3d, const char* in_2d) {
  const E_Array* list = dynamic_cast<const E_Array*>(named_[p]);
  if (!list || list->size() != d)
    forbid(p, std::string("= ") + (d == 2 ? in_2d : in_3d) + " on a " + (d == 2 ? "2" : "3") +
                  "D mesh");
  for (int c = 0; c < d; ++c) vectors_[p][c] = to<double>((*list)[c]);
}

void set_type_of_domain(const std::type_info& type) { parameters[p_domain].type = &type; }

Settings read_settings(Stack stack, const Arguments& args) {
  Settings s;
  s.method = choose(stack, args, p_method, methods, s.method);
  s.reg = choose(stack, args, p_reg, regularizations, s.reg);
  s.precon = choose(stack, args, p_precon, preconditioners, s.precon);
  s.step = choose(stack, args, p_step, steps, s.step);
  s.newton = args.value(stack, p_newton, s.newton);
  s.regeps = args.value(stack, p_regeps, s.regeps);
  s.omega = args.value(stack, p_omega, s.omega);
  s.tol = args.value(stack, p_tol, s.tol);
  if (args.has(p_nbiter)) s.nbiter = bound_on_iterations(args.value(stack, p_nbiter, 0.0));
  s.memory = 1e9 * args.value(stack, p_memory, s.memory / 1e9);
  s.threads = read_threads(stack, args);
  require(!args.has(p_regeps) || s.regeps != 0, p_regeps, 0, "leave it out to have the default");
  require(!args.has(p_omega) || s.omega != 0, p_omega, 0, "leave it out to have the default");
  refuse_without_effect(args, s);
  validate(s);
  return s;
}

Index read_threads(Stack stack, const Arguments& args) {
  // processes share the machine already; mpisize is 0 in FreeFem++ itself
  const long threads = args.value<long>(stack, p_threads, mpisize > 1 ? 1 : 0);
  require(!args.has(p_threads) || (threads >= 1 && threads <= 1024), p_threads, threads,
          "threads are 1 to 1024; leave it out to have as many as OMP_NUM_THREADS or the machine");
  return static_cast<Index>(threads);
}

long read_verb(Stack stack, const Arguments& args) {
  return args.value<long>(stack, p_verb, std::min(verbosity, 3L));
}

Site::Site(const basicAC_F0& args, int first, int count)
    : d(args[first].left() == atype<v_fes::pfes*>() ? 2 : 3), slave_(labels_of(args[first + 1])) {
  const auto space = [&](int k) {
    return d == 2 ? to<v_fes::pfes*>(args[k]) : to<v_fes3::pfes*>(args[k]);
  };
  spaces_.push_back(space(first));
  if (count > 3) spaces_.push_back(space(first + 2));
  if (count > 2) master_ = labels_of(args[first + count - 1]);
}

Spaces Site::spaces(Stack stack) const {
  if (spaces_.size() == 1) return {space_of(stack, d, spaces_[0], "Vh", 0)};
  const SpacePtr V1 = space_of(stack, d, spaces_[0], "V1", 0);
  return {V1, space_of(stack, d, spaces_[1], "V2", V1->dofs())};
}

bool Site::is_on_part(Stack stack) const {
  if (mpisize <= 1) return false;  // 0 in FreeFem++ itself
  const Spaces all = spaces(stack);
  return std::any_of(all.begin(), all.end(),
                     [](const SpacePtr& V) { return V->labels().count(cut) > 0; });
}

std::vector<long> Site::labels(Stack stack) const {
  return slave_(stack, master_ ? "slave" : "labels");
}

std::vector<long> Site::masters(Stack stack) const {
  return master_ ? master_(stack, "master") : std::vector<long>();
}

}  // namespace frictioncg
