#pragma once
#include "../core/assembly/dirichlet.h"
#include "../core/assembly/mortar/mortar.h"
#include "rigid_motion.h"

namespace frictioncg {

/// Bodies 0, 1, ...: how many.
inline Index count_of(const std::vector<Index>& body) {
  return body.empty() ? 0 : *std::max_element(body.begin(), body.end()) + 1;
}

/// Which rigid motions of bodies A leaves free.
class FreedomOfBodies {
 public:
  /// body: of each node on the interface, or on obstacles; extent: of these nodes, roughly.
  FreedomOfBodies(int d, const Extent& extent, std::vector<Index> body, Index bodies)
      : d_(d), extent_(extent), body_(std::move(body)), bodies_(bodies) {
    const Index k = generators().count();
    in_A_ = in_D_ = held_ = DenseMatrix::Zero(k, k * bodies_);
  }

  /// Adds the Gram matrices of the generators in A, in its diagonal, and over what Dirichlet
  /// conditions hold; of the dofs that are own, in one process all. A body that A couples to
  /// another is not free of it.
  void add(const Triplets& A, const Dirichlet& dirichlet, const std::vector<NodePlace>& places,
           const std::function<bool(Index)>& own = {}) {
    const Index k = generators().count();
    using Rows = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Rows w = rigid_modes(places, d_, A.n, extent_);
    Rows Aw = Rows::Zero(A.n, k);
    std::vector<Index> of(A.n, -1);
    for (const NodePlace& p : places)
      for (int c = 0; p.body < bodies_ && c < d_; ++c) of[p.dof[c]] = p.body;
    Vector D = Vector::Zero(A.n);
    for (std::size_t e = 0; e < A.size; ++e) {
      const Index i = A.row(e), j = A.col(e);
      if (of[i] < 0 || of[i] != of[j] || dirichlet.holds(i) || dirichlet.holds(j)) continue;
      Aw.row(i) += A.a[e] * w.row(j);
      if (A.half && i != j) Aw.row(j) += A.a[e] * w.row(i);
      if (i == j) D[i] += A.a[e];
    }
    for (Index i = 0; i < A.n; ++i) {
      if (of[i] < 0 || (own && !own(i))) continue;
      const auto add_to = [&](DenseMatrix& sum, const auto& row) {
        sum.middleCols(k * of[i], k).noalias() += w.row(i).transpose() * row;
      };
      if (dirichlet.holds(i)) add_to(held_, w.row(i));
      add_to(in_A_, Aw.row(i));
      add_to(in_D_, D[i] * w.row(i));
    }
  }

  void sum(const SumOverProcesses& over_processes) {
    for (DenseMatrix* all : {&in_A_, &in_D_, &held_})
      over_processes(all->data(), static_cast<Index>(all->size()));
  }

  mortar::Freedom freedom() const {
    mortar::Freedom freedom{generators(), body_, {}};
    const Index k = freedom.generators.count();
    for (Index b = 0; b < bodies_; ++b) {
      const DenseMatrix D = in_D_.middleCols(k * b, k);
      const DenseMatrix support = D.trace() * held_.middleCols(k * b, k);
      Index count = 0;
      const bool any = D.trace() > 0;
      const Eigenpairs found =
          any ? eigenpairs(in_A_.middleCols(k * b, k) + support, D + support) : Eigenpairs();
      while (any && count < k && found.values[count] <= resisted) ++count;
      freedom.of_body.push_back(any ? DenseMatrix(found.vectors.leftCols(count))
                                    : DenseMatrix(k, 0));
    }
    return freedom;
  }

 private:
  /// <Aw,w>/<Dw,w> up to which a motion counts as free: a support is stiffer than rounding.
  static constexpr Real resisted = 1e-10;

  /// Those of rigid_modes.
  RigidGenerators generators() const { return {d_, extent_.mean, extent_.radius}; }

  const int d_;
  const Extent extent_;
  const std::vector<Index> body_;
  const Index bodies_;
  DenseMatrix in_A_, in_D_, held_;  ///< k x k of each body, side by side
};

}  // namespace frictioncg
