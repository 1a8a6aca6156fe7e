#include "condensed/path_matrix.h"

namespace frictioncg {

void PathLaws::multiply(const System& system, const Vector& y, Vector& My) const {
  My += diagonal.cwiseProduct(y);
  if (symmetric) return;
  const Index offset = system.dofs() - static_cast<Index>(y.size());
  for (Index i = 0; i < system.nodes(); ++i) {
    const Index N = system.first[i] - offset, t = system.tangents(i);
    My.segment(N + 1, t) +=
        tangential.block(N + 1, 0, t, t) * y.segment(N + 1, t) + by_normal.segment(N + 1, t) * y[N];
  }
}

DensePathMatrix::DensePathMatrix(const CondensedProblem& problem) : laws_(problem.laws) {
  const Vector inverse = problem.D.cwiseSqrt().cwiseInverse();
  K_ = inverse.asDiagonal() * problem.S * inverse.asDiagonal();
  K_.diagonal().array() += problem.springs;
}

bool DensePathMatrix::factor(const PathLaws& laws) {
  symmetric_ = laws.symmetric;
  M_ = K_;
  M_.diagonal() += laws.diagonal;
  for (Index i = 0; i < laws_.nodes() && !symmetric_; ++i) {
    const Index N = laws_.system->first[i] - laws_.interior(), T = N + 1, t = laws_.tangents(i);
    M_.block(T, T, t, t) += laws.tangential.block(T, 0, t, t);
    M_.block(T, N, t, 1) += laws.by_normal.segment(T, t);
  }
  if (!(M_.diagonal().minCoeff() > 0) || !M_.allFinite()) return false;
  scale_ = M_.diagonal().cwiseSqrt().cwiseInverse();
  M_ = scale_.asDiagonal() * M_ * scale_.asDiagonal();
  if (symmetric_) return llt_.emplace(M_).found();
  single_.reset();
  if (M_.rows() >= large && !fine_)
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
