#include "linear_algebra.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace frictioncg {

DenseMatrix least_squares(const DenseRef& A, const DenseRef& B, Real threshold, Index* rank) {
  Eigen::CompleteOrthogonalDecomposition<DenseMatrix> decomposition;
  if (threshold > 0) decomposition.setThreshold(threshold);
  decomposition.compute(A);
  if (rank) *rank = static_cast<Index>(decomposition.rank());
  return decomposition.solve(B);
}

DenseMatrix solve(const DenseRef& A, const DenseRef& B) {
  return Eigen::FullPivLU<DenseMatrix>(A).solve(B);
}

Eigenpairs eigenpairs(const DenseRef& A) {
  const Eigen::SelfAdjointEigenSolver<DenseMatrix> found(A);
  return {found.eigenvalues(), found.eigenvectors()};
}

Eigenpairs eigenpairs(const DenseRef& A, const DenseRef& M) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<DenseMatrix> found(A, M);
  return {found.eigenvalues(), found.eigenvectors()};
}

DenseMatrix triangle(const DenseRef& A) {
  const Eigen::HouseholderQR<DenseMatrix> qr(A);
  const Eigen::Index k = A.cols(), rows = std::min(A.rows(), k);
  DenseMatrix R = DenseMatrix::Zero(k, k);
  R.topRows(rows) = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
  return R;
}

DenseMatrix orthonormal(const DenseRef& A) {
  return Eigen::HouseholderQR<DenseMatrix>(A).householderQ() *
         DenseMatrix::Identity(A.rows(), A.cols());
}

DenseMatrix null_space(const DenseRef& A, Real tolerance) {
  // a QR of our own before it: the one inside JacobiSVD frees twice where memory runs out
  const Eigen::JacobiSVD<DenseMatrix, Eigen::NoQRPreconditioner> svd(triangle(A),
                                                                     Eigen::ComputeFullV);
  return svd.matrixV().rightCols(A.cols() - (svd.singularValues().array() > tolerance).count());
}

Vector negative_direction(DenseMatrix M) {
  constexpr Real rounding = 1e-12;  // over the diagonal: a rigid motion leaves no more of a pivot
  const Index n = static_cast<Index>(M.rows());
  const auto row = [&](Index i, Index k) { return Vector(M.row(i).head(k).transpose()); };
  // p = v and what the first k rows, of which L has taken the place, make of that
  const auto completed = [&](Vector v, Index k, const Vector& of_first) {
    v.head(k) = -M.topLeftCorner(k, k).triangularView<Eigen::Lower>().transpose().solve(of_first);
    return v;
  };
  for (Index k = 0; k < n; ++k) {
    const Vector of_k = row(k, k);
    Vector column = M.col(k).tail(n - k);
    column.noalias() -= M.block(k, 0, n - k, k) * of_k;
    const Real pivot = column[0], size = std::abs(M(k, k));
    if (pivot < -rounding * size) return completed(Vector::Unit(n, k), k, of_k);
    if (pivot > rounding * size) {
      M.col(k).tail(n - k) = column / std::sqrt(pivot);
      continue;
    }
    for (Index j = k + 1; j < n; ++j) {  // d + 2 t c < 0, where t^2 costs nothing
      const Vector of_j = row(j, k);
      const Real c = column[j - k], d = M(j, j) - of_j.squaredNorm();
      if (c * c <= rounding * size * std::abs(M(j, j))) continue;
      const Real t = -(std::abs(d) + std::abs(c)) / c;
      return completed(Vector::Unit(n, j) + t * Vector::Unit(n, k), k, of_j + t * of_k);
    }
    M.col(k).tail(n - k).setZero();
    M(k, k) = 1;
  }
  return {};
}

}  // namespace frictioncg
