#pragma once
#include "parameters.h"
#include "space.h"

// FreeFEM's, whom this room and those of the space and of the operators know by more than name.
class E_F0;
class basicAC_F0;
template <class>
class KN;
template <class>
class KNM;
template <class>
class KN_;
using Expression = E_F0*;

namespace frictioncg {

/// The dofs of a call's space, or of its two spaces.
struct DofCount {
  long count = 0;
  long first = 0;  ///< of two spaces, those of the first
  /// "Vh has 72 degrees of freedom"; made when it is said, for nothing else needs its memory.
  std::string in_words() const;
};

[[noreturn]] void refuse_order(const DofCount& dofs);
/// Refuses a script's vector that is not finite, or not of the size of the space.
void check_vector(const Vector& v, const char* name, const DofCount& dofs);

/// A script's vector as it is now: what is evaluated after it may change the script's.
Vector copy_of(const KN_<double>& v);
Vector copy_of(const KN<double>* v);  ///< empty: null
Vector vector_of(Stack stack, Expression expression, const char* name);
/// Back to the script, where it asks for that; null: it does not.
void write(const Vector& values, KN<double>* out);
void write(const std::vector<long>& values, KN<long>* out);
void write(const std::vector<std::array<double, 4>>& rows, KNM<double>* out);

/// A view of the script's matrix. Its triplets are read as they lie: sorting them, as FreeFEM's own
/// CSR(), CSC() and COO() do in place, would invalidate a factorization that the script holds.
Triplets matrix_of(Stack stack, Expression A, const DofCount& dofs);

/// The labels of one boundary, once they are evaluated; what: the side of the contact, for
/// messages.
using Labels = std::function<std::vector<long>(Stack, const char* what)>;

/// The named parameters of one call, as expressions: what a script wrote, not yet evaluated.
class Arguments {
 public:
  /// Of a call that poses a problem of dimension d, normals and directions included.
  Arguments(const basicAC_F0& args, int d, bool two_bodies);
  /// Of a call on a contactproblem, whose geometry stands, or which is renewed: a new matrix may
  /// bring new normals along.
  static Arguments of_contactproblem(const basicAC_F0& args, bool renewed);
  /// A parameter of the constructor's that is not among `allowed` is refused.
  void allow_only(std::initializer_list<Parameter> allowed) const;
  bool has(Parameter p) const { return named_[p] != nullptr; }
  /// Whether one of several is there.
  bool has_any(std::initializer_list<Parameter> of) const {
    return std::any_of(of.begin(), of.end(), [this](Parameter p) { return has(p); });
  }
  /// Refuses those of several that are there.
  void refuse(std::initializer_list<Parameter> of, const char* why) const {
    for (Parameter p : of)
      if (has(p)) frictioncg::refuse(name_of(p), " ", why);
  }
  Parameter start() const { return has(p_start) ? p_start : p_init; }
  /// The dimension of normal or obstaclenormal, as given.
  int dimension(Parameter p) const { return vectors_[p][2] ? 3 : 2; }
  /// The labels of an obstacle beside pairs; none where there is none.
  std::vector<long> obstacle(Stack stack) const;
  /// Of a parameter that is there. T: bool, long, double, or a pointer to what is an output.
  template <class T>
  T value(Stack stack, Parameter p) const;
  template <class T>
  T value(Stack stack, Parameter p, T otherwise) const {
    return has(p) ? value<T>(stack, p) : otherwise;
  }
  template <class T>
  T* output(Stack stack, Parameter p) const {
    return value<T*>(stack, p, nullptr);
  }
  Vector vector(Stack stack, Parameter p) const;               ///< empty where it is not given
  std::vector<long> integers(Stack stack, Parameter p) const;  ///< likewise
  /// Likewise, and checked where it is given.
  Vector vector(Stack stack, Parameter p, const DofCount& dofs) const;
  /// Of normal, obstaclenormal, direction or pivot.
  double component(Stack stack, Parameter p, int c) const;
  Expression expression(Parameter p) const { return named_[p]; }

 private:
  using Components = std::array<Expression, 3>;
  explicit Arguments(const basicAC_F0& args);
  void components(Parameter p, int d, const char* in_3d, const char* in_2d);
  Expression named_[parameter_count];
  Components vectors_[parameter_count]{};
  Labels obstacle_;  ///< empty where there is none
};

/// The type of domain=, which frictionCG-mpi alone has.
void set_type_of_domain(const std::type_info& type);

/// The settings of a call. Refused here is what a script alone can say: zeros, which stand for the
/// defaults in the core.
Settings read_settings(Stack stack, const Arguments& args);

/// 0: as many as OpenMP has.
Index read_threads(Stack stack, const Arguments& args);

/// 0 silent, 1 plan and end, 2 iterations, 3 phases and counters: FreeFEM's verbosity, unless verb
/// is given.
long read_verb(Stack stack, const Arguments& args);

constexpr long cut = -111111;  ///< macro_ddm's label of what it cuts

/// Where a call looks for contact, its arguments between b and the options. Vh, labels: one body,
/// and an obstacle given by gap and normal. Vh, slave, master: two bodies in one space; V1, slave,
/// V2, master: in spaces of their own.
class Site {
 public:
  /// count: of the arguments from `first` on.
  Site(const basicAC_F0& args, int first, int count);

  const int d;  ///< dimension
  bool two_bodies() const { return master_ != nullptr; }
  Spaces spaces(Stack stack) const;
  /// Under several processes: whether a mesh is the part of one that FreeFEM's macro_ddm.idp has
  /// distributed. A mesh that each process has for itself is none.
  bool is_on_part(Stack stack) const;
  std::vector<long> labels(Stack stack) const;   ///< of the slave, of two bodies
  std::vector<long> masters(Stack stack) const;  ///< none where there is one body

 private:
  std::vector<Expression> spaces_;  ///< one, or those of slave and master
  Labels slave_, master_;           ///< the latter empty where there is one body
};

}  // namespace frictioncg
