#pragma once
#include "multigrid/block_matrix.h"

namespace frictioncg {

/// Both halves of A, by slots.
template <int B>
Eigen::MatrixXd dense(const SymmetricBlocks<B>& A) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(Eigen::Index(A.rows()) * B, Eigen::Index(A.rows()) * B);
  using Block = Eigen::Map<const Eigen::Matrix<float, B, B, Eigen::RowMajor>>;
  for (Index i = 0; i < A.rows(); ++i) {
    M.template block<B, B>(i * B, i * B) = Block(A.diagonal_at(i)).template cast<Real>();
    for (Index k = A.row[i]; k < A.row[i + 1]; ++k) {
      const auto a = Block(A.at(k)).template cast<Real>();
      M.template block<B, B>(i * B, A.col[k] * B) = a;
      M.template block<B, B>(A.col[k] * B, i * B) = a.transpose();
    }
  }
  return M;
}

template <int R, int C>
Eigen::MatrixXd dense(const Prolongation<R, C>& P) {
  Eigen::MatrixXd M =
      Eigen::MatrixXd::Zero(Eigen::Index(P.rows()) * R, Eigen::Index(P.columns) * C);
  for (Index i = 0; i < P.rows(); ++i)
    for (Index q = P.row[i]; q < P.row[i + 1]; ++q)
      M.template block<R, C>(i * R, P.col[q] * C) =
          Eigen::Map<const Eigen::Matrix<float, R, C, Eigen::RowMajor>>(P.at(q))
              .template cast<Real>();
  return M;
}

}  // namespace frictioncg
