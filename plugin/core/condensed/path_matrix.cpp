#include "condensed/path_matrix.h"

namespace frictioncg {

DensePathMatrix::DensePathMatrix(const CondensedProblem& problem) : laws_(problem.laws) {
  const Vector inverse = problem.D.cwiseSqrt().cwiseInverse();
  K_ = inverse.asDiagonal() * problem.S * inverse.asDiagonal();
  K_.diagonal().array() += problem.springs;
}

bool DensePathMatrix::factor(const PathLaws& laws) {
  symmetric_ = laws.symmetric;
  M_ = K_;
  for (Index i = 0; i < laws_.nodes(); ++i) {
    const Index N = laws_.system->first[i] - laws_.interior(), size = laws_.tangents(i) + 1;
    M_.block(N, N, size, size) += laws.blocks[i];
  }
  if (!(M_.diagonal().minCoeff() > 0) || !M_.allFinite()) return false;
  scale_ = M_.diagonal().cwiseSqrt().cwiseInverse();
  M_ = scale_.asDiagonal() * M_ * scale_.asDiagonal();
  if (symmetric_) return llt_.emplace(M_).found();
  single_.reset();
  if (M_.rows() >= single_pays && !fine_)
    single_ = std::make_unique<const SinglePrecision>(M_);
  else
    lu_.emplace(M_);
  return true;
}

Vector DensePathMatrix::solve(const Vector& b) {
  const Vector scaled = scale_.cwiseProduct(b);
  if (symmetric_) return scale_.cwiseProduct(llt_->solve(scaled));
  if (single_) {
    const Vector y = single_->solve(scaled);
    if (y.size() > 0) return scale_.cwiseProduct(y);
    fine_ = true;
    single_.reset();
    lu_.emplace(M_);
  }
  return scale_.cwiseProduct(lu_->solve(scaled));
}

}  // namespace frictioncg
