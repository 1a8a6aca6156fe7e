#include "factorization.h"

namespace frictioncg {

namespace {
/// Refinement gains a digit a step, or has come to its end, which is rounding.
constexpr Real digit = 0.1, refined = 1e-13;
}  // namespace

Cholesky::Cholesky(DenseMatrix& M) : llt_(M) {}
Real Cholesky::rcond() const { return llt_.rcond(); }
Vector Cholesky::solve(const Vector& b) const { return llt_.solve(b); }
DenseMatrix Cholesky::solve(const DenseMatrix& B) const { return llt_.solve(B); }

LU::LU(DenseMatrix& M) : lu_(M) {}
Real LU::rcond() const { return lu_.rcond(); }
Vector LU::solve(const Vector& b) const { return lu_.solve(b); }

SinglePrecision::SinglePrecision(const DenseMatrix& M) : M_(M), lu_(M.cast<float>()) {}

Vector SinglePrecision::solve(const Vector& b) const {
  Vector y = Vector::Zero(b.size()), r = b;
  Real before = r.norm();
  while (before > 0) {
    const Real size = before;  // keeps the residual in the range of single precision
    y += size * lu_.solve((r / size).cast<float>()).cast<Real>();
    r = b;
    r.noalias() -= M_ * y;
    const Real after = r.norm();
    if (!(after <= digit * before)) {
      if (!(after <= refined * (b.norm() + M_.norm() * y.norm()))) return {};
      break;
    }
    before = after;
  }
  return y;
}

}  // namespace frictioncg
