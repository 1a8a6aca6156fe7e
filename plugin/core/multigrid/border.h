#pragma once
#include "multigrid/block_matrix.h"

namespace frictioncg {

/// The rows of k unknowns q beside those of a level, [A B; B' S]: they are at no place, and the
/// same on all levels. Few blocks of R rows of B are not 0.
template <int R>
struct LevelBorder {
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<Index> block;  ///< those that are not 0
  Rows B;                    ///< their rows, R a block, by k
  Vector r, z;               ///< k
  Vector first_r, first_z;   ///< of the first of two cycles

  /// v -= B q
  void subtract(const Vector& q, float* v) const {
    for (std::size_t b = 0; b < block.size(); ++b)
      Eigen::Map<Eigen::Matrix<float, R, 1>>(v + std::size_t(block[b]) * stride<R>) -=
          B.template middleRows<R>(Eigen::Index(b) * R)
              .template cast<Real>()
              .lazyProduct(q)
              .template cast<float>();
  }
  /// q -= B' v
  void subtract_transposed(const float* v, Vector& q) const {
    for (std::size_t b = 0; b < block.size(); ++b)
      for (int s = 0; s < R; ++s)
        q -= Real(v[std::size_t(block[b]) * stride<R> + s]) *
             B.row(Eigen::Index(b) * R + s).transpose().template cast<Real>();
  }
  void allocate(Eigen::Index k) {
    for (Vector* q : {&r, &z, &first_r, &first_z}) q->setZero(k);
  }
};

/// coarse.B = P' fine.B
template <int R, int C>
void restrict_border(const Prolongation<R, C>& P, const LevelBorder<R>& fine,
                     LevelBorder<C>& coarse) {
  std::vector<Index> at(P.columns, -1);
  coarse.block.clear();
  for (const Index i : fine.block)
    for (Index q = P.row[i]; q < P.row[i + 1]; ++q) {
      if (at[P.col[q]] >= 0) continue;
      at[P.col[q]] = static_cast<Index>(coarse.block.size());
      coarse.block.push_back(P.col[q]);
    }
  coarse.B.setZero(Eigen::Index(coarse.block.size()) * C, fine.B.cols());
  for (std::size_t b = 0; b < fine.block.size(); ++b)
    for (Index q = P.row[fine.block[b]]; q < P.row[fine.block[b] + 1]; ++q) {
      const Eigen::Map<const Eigen::Matrix<float, R, C, Eigen::RowMajor>> p(P.at(q));
      coarse.B.template middleRows<C>(Eigen::Index(at[P.col[q]]) * C) +=
          p.transpose().lazyProduct(fine.B.template middleRows<R>(Eigen::Index(b) * R));
    }
}

}  // namespace frictioncg
