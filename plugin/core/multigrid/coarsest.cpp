#include "multigrid/coarsest.h"

namespace frictioncg {

void CoarsestSolver::factor(Eigen::MatrixXd A, Real shift) {
  A_ = std::move(A);
  x_.resize(A_.rows());
  const Vector diagonal = A_.diagonal();
  for (Real s = shift; s < 1; s *= 10) {
    for (Eigen::Index k = 0; k < diagonal.size(); ++k)
      A_(k, k) = diagonal[k] > 0 ? (1 + s) * diagonal[k] : 1;
    llt_.compute(A_);
    if (llt_.info() == Eigen::Success) break;
  }
}

void CoarsestSolver::solve(const std::vector<float>& r, std::vector<float>& z) {
  for (Eigen::Index k = 0; k < x_.size(); ++k) x_[k] = r[k];
  llt_.solveInPlace(x_);
  for (Eigen::Index k = 0; k < x_.size(); ++k) z[k] = static_cast<float>(x_[k]);
}

}  // namespace frictioncg
