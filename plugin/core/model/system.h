#pragma once
#include "types.h"

namespace frictioncg {

/// Disjoint sets of 0 .. n-1.
class Groups {
 public:
  explicit Groups(Index n);
  Index of(Index i);  ///< the least number of its set
  void join(Index i, Index j);

 private:
  std::vector<Index> parent_;
};

/// Which part of a scene that hangs together each dof belongs to.
struct Bodies {
  std::vector<Index> of;  ///< n, numbered from 0
  Index count = 0;        ///< on all processes
};

/// Candidates for rigid motions: n x k, made when asked for. None of them need be in the kernel of
/// A: a support or a link may stand against it.
using RigidModes = std::function<Eigen::MatrixXd()>;
/// The same of many bodies, most of whose rows are 0.
using BodyModes = std::function<Matrix()>;
/// What the places of the nodes tell. An empty function: not known.
struct BodyShape {
  RigidModes rigid_modes = {};  ///< of all bodies as if they were one
  BodyModes body_modes = {};    ///< of each body alone, where a coupling joins them in A
  /// Of all bodies together: the longest over the shortest radius of gyration of the mesh nodes,
  /// about L/t of a beam or a plate.
  std::function<Real()> slenderness = {};
};
/// Takes row i of a product: the columns that may not be 0, and all values, by column.
using VisitRow =
    std::function<void(Index i, const std::vector<Index>& columns, const Vector& values)>;

/// What stays from increment to increment: the matrix A (n x n, symmetric positive semi-definite
/// [force/length]), and where its contact nodes lie. Immutable from construction.
///
/// The interior dofs come first, then the contact nodes one by one, each with its normal dof
/// followed by its tangential dofs: two in 3D, one in 2D, none where there is no friction.
///
/// Several processes may share it: each owns some of the dofs and nodes, holds vectors and products
/// of that size, and calls the same functions in the same order as all others.
struct System : BodyShape {  // with motions in local frames
  virtual ~System() = default;

  int dimension = 2;         ///< 2 or 3
  Vector D;                  ///< n, diag(A)
  Vector weight;             ///< n, of node_weights: the stiffness that residuals are divided by
  std::vector<Index> first;  ///< m + 1; contact node i owns the dofs first[i] .. first[i+1]-1
  std::vector<Index> mesh_node;  ///< n, or empty: dofs with one number share a mesh node (fill-in)
  /// n x k, or empty: the last k interior dofs are at no place, but motions of obstacles, with
  /// dense rows in A. These columns move an obstacle along one of them alone, A border = 0.
  Matrix border;
  Matrix inertia;  ///< n x k, of inertia_of

  Index dofs() const { return first.back(); }
  Index nodes() const { return static_cast<Index>(first.size()) - 1; }
  Index interior() const { return first.front(); }
  Index contact_dofs() const { return dofs() - interior(); }
  Index tangents(Index i) const { return first[i + 1] - first[i] - 1; }

  virtual void multiply(const Vector& x, Vector& Ax) const = 0;  ///< Ax = A x
  /// The same; returns |A||x|: rounding of Ax is about 2^-53 of it.
  virtual Vector multiply_sized(const Vector& x, Vector& Ax) const = 0;
  /// r -= A dx, where dx_C (contact_dofs) alone is not 0, by the rows of what moved.
  virtual void move_contact(const Vector& dx_C, Vector& r) const = 0;
  virtual Bodies bodies() const = 0;  ///< in the graph of A
  /// A itself, for what needs its entries. Throws std::logic_error where processes share them.
  virtual const Matrix& entries() const = 0;

  // Over all processes; of one alone, what it has:
  /// Adds up each of the values, in place.
  virtual void sum(Real* /*values*/, Index /*count*/) const {}
  virtual Real largest(Real value) const { return value; }
  /// The vectors of all, one after the other.
  virtual Vector gathered(const Vector& own) const { return own; }
  /// One vector in place of those of all, of one size, by what stands for two of them.
  using Both = std::function<Vector(const Vector&, const Vector&)>;
  virtual Vector combined(const Vector& own, const Both& /*both*/) const { return own; }
  virtual void product(const Matrix& M, const VisitRow& visit) const;  ///< the rows of A M
  Real sum(Real value) const {
    sum(&value, 1);
    return value;
  }
};

/// The bodies of a scene: parts of the graph of A that share no entry.
Bodies bodies_of(const Matrix& A);

/// A system that one process holds whole.
struct AssembledSystem final : System {
  Matrix A;

  void multiply(const Vector& x, Vector& Ax) const override;
  void product(const Matrix& M, const VisitRow& visit) const override;
  Vector multiply_sized(const Vector& x, Vector& Ax) const override;
  void move_contact(const Vector& dx_C, Vector& r) const override;
  Bodies bodies() const override { return bodies_of(A); }
  const Matrix& entries() const override { return A; }
};

/// Whether two systems have their contact dofs and their mesh nodes in the same places.
bool same_dofs(const System& one, const System& other);
/// The same, and the entries of A: what is laid out by the one then serves the other.
bool same_pattern(const System& one, const System& other);

/// Whether a motion w costs no energy, by <Aw,w> and <Dw,w>. The entries of A, each rounded to
/// 1e-16, leave up to 1e-15 of <Dw,w> of a rigid motion; a support of a trillionth of the body's
/// stiffness leaves some 1e-14, and is one. times: how often the rounding of a product with A
/// in_A carries.
inline bool costs_no_energy(Real in_A, Real in_D, Real times = 1) {
  return in_A <= times * 1e-14 * in_D;
}
bool costs_no_energy(const System& system, const Vector& w);
/// Whether p'Ap < 0 beyond the rounding of |p|'|A||p|, on the matrix itself: what a method met on
/// its way may be drift, or the rounding of an elimination. p: n, or empty on all processes.
bool costs_negative_energy(const System& system, const Vector& p);

/// One stiffness per mesh node, the mean of its part of diag(A), spread over its dofs: a trace,
/// which does not turn with the axes. A contact node has two, of its normal and of its tangents,
/// whose frame turns with the body. Dofs without a mesh node have their own.   n, from D, first,
/// mesh_node
///
/// A penalty holds a dof where w > most, 1e6 times the median of w, or of the contact
/// dofs' where that is more, and where A resists rigid motions, as no body does, however stiff. A
/// force r there counts by the displacement r/w that it makes, against the stiffness `most`: the
/// weight is w^2 / most. By w alone the forces that a penalty takes, of the size of w, would hide
/// all others.
Vector node_weights(const System& system);

/// A dof with a penalty so large that A has rounded away the stiffness or the force beside it.
struct LostPenalty {
  Index dof;
  bool aslant;  ///< along a direction between the axes of its node, across which the body's
                ///< stiffness is lost; otherwise of a contact node, whose force is
};
/// None where mesh_node is not known.
std::vector<LostPenalty> lost_penalties(const System& system);

/// How many times as stiff A is at one node as at another, nodes aside that penalties hold.
Real contrast(const System& system);

/// Filled where it lies (Eigen 3.4 copies a sparse matrix that is moved), then shared as const.
using SystemPtr = std::shared_ptr<const System>;

}  // namespace frictioncg
