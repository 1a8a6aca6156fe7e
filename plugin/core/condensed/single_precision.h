#pragma once
#include <Eigen/LU>

#include "condensed/condensed_problem.h"

namespace frictioncg {

/// LU factors of M in single precision, at half the cost of double, and iterative refinement. M
/// stays where it is, and as it is, as long as this lives.
class SinglePrecision {
 public:
  explicit SinglePrecision(const DenseMatrix& M);

  /// M^{-1} b to rounding; empty where M is too ill-conditioned for it.
  Vector solve(const Vector& b) const;

 private:
  const DenseMatrix& M_;
  Eigen::PartialPivLU<Eigen::MatrixXf> lu_;
};

/// Unknowns from which the factorization dominates a step, so that single precision pays.
constexpr Index large = 500;

}  // namespace frictioncg
