#pragma once
#include "../freefem/freefem.h"

#include "../freefem/scene.h"
#include "domain.h"

namespace frictioncg {

// What a process learns of the nodes that it shares: their owners alone have all elements around
// them, and see normals, weights and supports as one process would.

/// A domain of another decomposition of the mesh names other dofs: where its owners have what this
/// process has elsewhere, it is not the domain of this space.   Collective.
inline void refuse_other_domain(const Domain& domain, const std::vector<NodePlace>& places) {
  constexpr Real elsewhere = 1e-6;  // over the largest coordinate
  Eigen::MatrixXd at = Eigen::MatrixXd::Zero(3, domain.dofs());
  for (const NodePlace& n : places)
    for (Index dof : n.dof)
      if (dof >= 0) at.col(dof) = n.x;
  const Eigen::MatrixXd theirs = domain.of_owners(at);
  const Real size = at.size() > 0 ? at.cwiseAbs().maxCoeff() : 0;
  const bool together = ((at - theirs).cwiseAbs().array() <= elsewhere * size).all();
  if (domain.largest(!together) > 0)
    throw IllegalInput(
        "the domain belongs to another decomposition of the mesh: what processes share lies at "
        "different places; make it by createMat(Th, C, Pk) with the mesh of Vh");
}

/// Adds the contact points of ghosts, as their owners have them: point by point of a node, in the
/// owner's order.
inline void add_ghost_points(const Domain& domain, Scene& scene) {
  struct Sent {
    std::size_t place;  ///< of the node's first dof among those shared
    Vec3 x;
    long label;
    ContactPoint point;
  };
  const auto shift = [&](ContactPoint& point, Index by) {
    for (int c = 0; c < scene.d; ++c) point.dof[c] += by;
  };
  std::map<Index, std::vector<BoundaryNode>> points;
  for (const BoundaryNode& n : scene.nodes) points[n.point.dof[0]].push_back(n);
  const auto pack = [&](const std::vector<Index>& dofs) {
    std::vector<Sent> sent;
    for (std::size_t k = 0; k < dofs.size(); ++k)
      if (const auto found = points.find(dofs[k]); found != points.end())
        for (const BoundaryNode& n : found->second) {
          sent.push_back({k, n.x, n.label, n.point});
          shift(sent.back().point, -dofs[k]);
        }
    return sent;
  };
  const auto unpack = [&](const std::vector<Index>& dofs, const std::vector<Sent>& received) {
    for (const Sent& from : received) {
      BoundaryNode& n = scene.nodes.emplace_back();
      n.x = from.x;
      n.label = from.label;
      n.point = from.point;
      shift(n.point, dofs[from.place]);
    }
  };
  domain.tell<Sent>(pack, unpack);
}

/// The script's matrix, with Dirichlet rows of ghosts that this process does not see as such: the
/// facets that hold them may be another's.
class PatchedMatrix {
 public:
  /// Collective. own: what this process's own matrix holds.
  PatchedMatrix(const Domain& domain, const Triplets& A, const Dirichlet& own)
      : triplets_(A), diagonal_(Vector::Zero(A.n)), held_(A.n) {
    triplets_.owned = domain.owned();
    for (Index i = 0; i < A.n; ++i) held_[i] = own.holds(i);
    domain.update(held_);
    for (std::size_t k = 0; k < A.size; ++k)
      if (A.row(k) == A.col(k)) diagonal_[A.row(k)] += A.a[k];
    for (std::size_t k = 0; k < A.size; ++k) {
      const Index i = A.row(k);
      if (i != A.col(k) || held_[i] == 0 || own.holds(i)) continue;
      if (values_.empty()) values_.assign(A.a, A.a + A.size);
      values_[k] = diagonal_[i] = huge * diagonal_[i];
    }
    if (!values_.empty()) triplets_.a = values_.data();
  }
  /// As long as the matrix and the domain of the constructor live.
  const Triplets& triplets() const { return triplets_; }
  /// b, with the data of ghosts that their owners' b has. Collective.
  Vector load(const Domain& domain, const Vector& b) const {
    Vector data = Vector::Zero(b.size()), patched = b;
    for (Index i = 0; i < b.size(); ++i)
      if (held_[i] != 0) data[i] = b[i] / diagonal_[i];
    domain.update(data);
    for (Index i = 0; i < b.size(); ++i)
      if (held_[i] != 0 && !domain.owns(i)) patched[i] = data[i] * diagonal_[i];
    return patched;
  }

 private:
  static constexpr Real huge = 1e20;  ///< over the row: what the core takes for a Dirichlet row
  Triplets triplets_;
  std::vector<Real> values_;  ///< empty where A serves as it is
  Vector diagonal_, held_;    ///< n
};

}  // namespace frictioncg
