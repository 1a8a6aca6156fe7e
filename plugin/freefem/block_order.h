#pragma once
#include "freefem.h"

#include "scene.h"

namespace frictioncg {

/// What a block of A is to the nodes of a space: rows that translations leave without a force, and
/// those of them that rotations leave without a force, too: all, but with the places of another
/// mesh.
struct BlockFit {
  Index translated = 0, rotated = 0;
  bool holds() const { return translated > 0 && rotated == translated; }
  bool fails() const { return rotated < translated; }
};

/// The dofs of two spaces, of as many dofs each, with the places of their nodes.
class BlockOrder {
 public:
  BlockOrder(const std::vector<NodePlace>& places, int d, const DofCount& dofs)
      : d_(d), first_(dofs.first), component_(dofs.count, -1), x_(dofs.count) {
    for (const NodePlace& n : places)
      for (int c = 0; c < d; ++c) {
        component_[n.dof[c]] = c;
        x_[n.dof[c]] = position(n);
      }
  }
  /// Whether the blocks are those of the spaces in the other order, and not in this one.
  bool exchanged(const Triplets& A) const {
    const std::array<BlockFit, 2> some = fits(A, first_, 1 + first_ / 100);  // mostly they tell
    if (some[0].fails() || some[1].fails()) return false;
    const std::array<BlockFit, 2> given = fits(A, 0, 1), other = fits(A, first_, 1);
    return other[0].holds() && other[1].holds() && !given[0].holds() && !given[1].holds();
  }
  long elsewhere(long dof) const { return dof < first_ ? dof + first_ : dof - first_; }

 private:
  struct Row {
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
    Real size = 0, arm = 0;  ///< of what was summed
  };
  /// The fits of each `step`-th row of both blocks, which have the places of others: by `shift`.
  std::array<BlockFit, 2> fits(const Triplets& A, long shift, long step) const {
    std::vector<Row> rows(A.n);
    std::vector<char> counts(A.n, 0);
    for (long i = 0; i < A.n; i += step) counts[i] = 1;
    for (std::size_t k = 0; k < A.size; ++k) {
      const long i = A.row(k), j = A.col(k);
      if (counts[i]) add(i, j, A.a[k], shift, rows[i]);
      if (A.half && i != j && counts[j]) add(j, i, A.a[k], shift, rows[j]);
    }
    constexpr Real rounding = 1e-9;
    std::array<BlockFit, 2> fit;
    for (long i = 0; i < A.n; ++i) {
      const Row& r = rows[i];
      if (!(r.size > 0) || r.force.norm() > rounding * r.size) continue;
      BlockFit& of = fit[i < first_ ? 0 : 1];
      ++of.translated;
      of.rotated += r.moment.norm() <= rounding * r.arm;
    }
    return fit;
  }
  void add(long i, long j, Real a, long shift, Row& row) const {
    const long p = shift ? elsewhere(i) : i, q = shift ? elsewhere(j) : j;
    if (component_[p] < 0 || component_[q] < 0) return;
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(component_[q]), arm = x_[q] - x_[p];
    row.force += a * e;
    row.moment += a * (d_ == 2 ? Eigen::Vector3d(0, 0, arm.cross(e)[2]) : arm.cross(e));
    row.size += std::abs(a);
    row.arm += std::abs(a) * arm.norm();
  }

  int d_;
  long first_;
  std::vector<int> component_;
  std::vector<Eigen::Vector3d> x_;
};

/// Refuses the blocks of two spaces of as many dofs that come in the other order: where the
/// stiffness belongs to the other mesh, or, of meshes that differ by a translation, where supports
/// hold the whole slave, and none of it in the other order.
inline void refuse_exchanged_blocks(const Scene& scene, const Triplets& A) {
  if (scene.dofs.first == 0 || 2 * scene.dofs.first != scene.dofs.count) return;
  const BlockOrder order(scene.places(), scene.d, scene.dofs);
  if (order.exchanged(A)) refuse_order(scene.dofs);
  const Dirichlet held(A, {});
  Index here = 0, there = 0, all = 0;
  for (const BoundaryNode& n : scene.pairing->slave_nodes())
    for (int c = 0; c < scene.d; ++c) {
      if (n.point.normal[c] == 0) continue;
      ++all;
      here += held.holds(n.point.dof[c]);
      there += held.holds(static_cast<Index>(order.elsewhere(n.point.dof[c])));
    }
  if (here < all || there > 0) return;
  throw IllegalInput(
      "Dirichlet conditions hold the normal of every slave node, and of none if the blocks come in "
      "the other order: A = [[A1, 0], [0, A2]] and b = [b1, b2] have those of V1, the space of the "
      "slave, first; exchange them, or, where they are right, swap slave and master");
}

}  // namespace frictioncg
