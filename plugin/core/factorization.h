#pragma once
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "types.h"

namespace frictioncg {

// The factorizations of large dense matrices, compiled once, as those of linear_algebra.h are.

/// M = LL' in the place of M.
class Cholesky {
 public:
  explicit Cholesky(DenseMatrix& M);
  bool found() const { return llt_.info() == Eigen::Success; }  ///< M is positive definite
  Real rcond() const;
  Vector solve(const Vector& b) const;
  DenseMatrix solve(const DenseMatrix& B) const;

 private:
  Eigen::LLT<Eigen::Ref<DenseMatrix>> llt_;
};

/// PM = LU in the place of M.
class LU {
 public:
  explicit LU(DenseMatrix& M);
  Real rcond() const;
  Vector solve(const Vector& b) const;

 private:
  Eigen::PartialPivLU<Eigen::Ref<DenseMatrix>> lu_;
};

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

/// Unknowns from which the factorization dominates what is done with it, so that single precision
/// pays.
constexpr Index single_pays = 500;

}  // namespace frictioncg
