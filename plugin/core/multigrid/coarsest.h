#pragma once
#include <Eigen/Cholesky>

#include "types.h"

namespace frictioncg {

/// The solution on the coarsest level by a dense factorization, in double precision.
class CoarsestSolver {
 public:
  /// A: symmetric positive semi-definite; rows of 0 get the solution r itself. A kernel is shifted
  /// away: by `shift` of the diagonal, or tenfold as often as it takes.
  void factor(Eigen::MatrixXd A, Real shift);
  bool factored() const { return A_.size() > 0; }
  void solve(Vector& z) const { llt_.solveInPlace(z); }
  double bytes() const { return 2.0 * sizeof(Real) * double(A_.size()); }

 private:
  Eigen::MatrixXd A_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
};

}  // namespace frictioncg
