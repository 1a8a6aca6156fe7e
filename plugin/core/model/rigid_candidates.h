#pragma once
#include "model/system.h"

namespace frictioncg {

/// Candidates for motions that A leaves free: rigid motions of the bodies, n x k, whether supports
/// resist them or not. No columns where the system knows none, or none of n rows.
Matrix rigid_candidates(const System& system);

/// The same, by the bodies that they move: parts of the graph of A, which share no entry of it.
/// Collective.   of_system: outlives it
class RigidCandidates {
 public:
  explicit RigidCandidates(const System& of_system);

  Index count() const { return static_cast<Index>(M.cols()); }
  /// Of candidate j among those of a body; negative where it is none of them.
  Index place(Index body, Index j) const {
    const std::vector<Index>& own = of_body[body];
    if (static_cast<Index>(own.size()) == count()) return j;
    const auto found = std::lower_bound(own.begin(), own.end(), j);
    return found != own.end() && *found == j ? Index(found - own.begin()) : -1;
  }
  using Visit = std::function<void(Index i, Index j, Real value)>;
  /// Sums over each body's dofs of M_i' R_i, for entries (i, j, value) of R, whose columns are
  /// those of the candidates: one matrix a body.
  std::vector<DenseMatrix> gram(const std::function<void(const Visit&)>& for_each) const;
  /// The same of the candidates in the product of a diagonal.
  std::vector<DenseMatrix> gram_in(const Vector& diagonal) const;
  /// What they make of w at best, body by body:   M (M'M)^+ M'w
  Vector nearest_to(const Vector& w) const;

  Matrix M;  ///< n x k; no columns where the system knows none, or none of use
  Bodies bodies;
  std::vector<std::vector<Index>> of_body;  ///< which of them move something of a body, ascending

 private:
  /// Adds up those of all processes, in one go.
  void sum(std::vector<DenseMatrix>& of_bodies) const;

  const System& system_;
};

}  // namespace frictioncg
