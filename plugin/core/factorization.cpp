#include "factorization.h"

namespace frictioncg {

Cholesky::Cholesky(DenseMatrix& M) : llt_(M) {}
Real Cholesky::rcond() const { return llt_.rcond(); }
Vector Cholesky::solve(const Vector& b) const { return llt_.solve(b); }
DenseMatrix Cholesky::solve(const DenseMatrix& B) const { return llt_.solve(B); }

LU::LU(DenseMatrix& M) : lu_(M) {}
Real LU::rcond() const { return lu_.rcond(); }
Vector LU::solve(const Vector& b) const { return lu_.solve(b); }

}  // namespace frictioncg
