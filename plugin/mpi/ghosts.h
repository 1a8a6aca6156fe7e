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
  Eigen::MatrixXd theirs = at;
  domain.update(theirs);
  const Real size = at.size() > 0 ? at.cwiseAbs().maxCoeff() : 0;
  const bool together = ((at - theirs).cwiseAbs().array() <= elsewhere * size).all();
  if (domain.largest(!together) > 0)
    throw IllegalInput(
        "the domain belongs to another decomposition of the mesh: what processes share lies at "
        "different places; make it by createMat(Th, C, Pk) with the mesh of Vh");
}

/// Calls visit for each number that is sent of a contact point.
template <class Visit>
void for_each_number(BoundaryNode& n, const Visit& visit) {
  ContactPoint& p = n.point;
  for (int c = 0; c < 3; ++c) {
    visit(n.x[c]);
    visit(p.normal[c]);
    visit(p.direction[c]);
    visit(p.dof[c]);
  }
  visit(n.label);
  visit(p.friction);
  visit(p.mu_ratio);
}

/// Adds the contact points of ghosts, as their owners have them: point by point of a node, in the
/// owner's order.
inline void add_ghost_points(const Domain& domain, Scene& scene) {
  constexpr Index of_point = 15, most = 3;
  std::map<Index, std::vector<BoundaryNode>> points;
  for (const BoundaryNode& n : scene.nodes) points[n.point.dof[0]].push_back(n);
  const auto pack = [&](Index dof, Real* out) {
    std::fill(out, out + 1 + most * of_point, 0);
    const auto found = points.find(dof);
    if (found == points.end()) return;
    *out++ = static_cast<Real>(found->second.size());
    for (BoundaryNode n : found->second) {
      for (Index& of_component : n.point.dof) of_component -= dof;
      for_each_number(n, [&](const auto& value) { *out++ = static_cast<Real>(value); });
    }
  };
  const auto unpack = [&](Index dof, const Real* in) {
    for (Index count = static_cast<Index>(*in++); count > 0; --count) {
      BoundaryNode n;
      for_each_number(
          n, [&](auto& value) { value = static_cast<std::decay_t<decltype(value)>>(*in++); });
      for (Index& of_component : n.point.dof) of_component += dof;
      scene.nodes.push_back(n);
    }
  };
  domain.update(1 + most * of_point, pack, unpack);
}

/// The script's matrix, with Dirichlet rows of ghosts that this process does not see as such: the
/// facets that hold them may be another's.
class PatchedMatrix {
 public:
  /// Collective. own: what this process's own matrix holds.
  PatchedMatrix(const Domain& domain, const Triplets& A, const Dirichlet& own)
      : owned_(domain.owned()) {
    Vector held(A.n);
    for (Index i = 0; i < A.n; ++i) held[i] = own.holds(i);
    domain.update(held);
    diagonal_ = Vector::Zero(A.n);
    for (std::size_t k = 0; k < A.size; ++k)
      if (A.row(k) == A.col(k)) diagonal_[A.row(k)] += A.a[k];
    for (std::size_t k = 0; k < A.size; ++k) {
      const Index i = A.row(k);
      if (i != A.col(k) || held[i] == 0 || own.holds(i)) continue;
      if (values_.empty()) values_.assign(A.a, A.a + A.size);
      values_[k] = diagonal_[i] = huge * diagonal_[i];
    }
    held_ = held;
  }
  /// A being that of the constructor, whose domain stays.
  Triplets triplets(const Triplets& A) const {
    Triplets patched = A;
    if (!values_.empty()) patched.a = values_.data();
    patched.owned = owned_;
    return patched;
  }
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
  const char* owned_;                 ///< n
  std::vector<Real> values_;          ///< empty where A serves as it is
  Vector diagonal_, held_;            ///< n
};

}  // namespace frictioncg
