#include <Eigen/Eigenvalues>

#include "linear_algebra.h"

namespace frictioncg {

Eigenpairs eigenpairs(const DenseRef& A) {
  const Eigen::SelfAdjointEigenSolver<DenseMatrix> found(A);
  return {found.eigenvalues(), found.eigenvectors()};
}

Eigenpairs eigenpairs(const DenseRef& A, const DenseRef& M) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<DenseMatrix> found(A, M);
  return {found.eigenvalues(), found.eigenvectors()};
}

}  // namespace frictioncg
