#include "multigrid/coarsest.h"

namespace frictioncg {

void CoarsestSolver::factor(Eigen::MatrixXd A, Real shift) {
  A_ = std::move(A);
  const Vector diagonal = A_.diagonal();
  for (Real s = shift; s < 1; s *= 10) {
    for (Eigen::Index k = 0; k < diagonal.size(); ++k)
      A_(k, k) = diagonal[k] > 0 ? (1 + s) * diagonal[k] : 1;
    llt_.compute(A_);
    if (llt_.info() == Eigen::Success) break;
  }
}

}  // namespace frictioncg
