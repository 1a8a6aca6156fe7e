#include "multigrid/dense_hierarchy.h"

namespace frictioncg {

void DenseHierarchy::truncate(const std::vector<char>& fixed,
                              const std::vector<TangentialStiffness>& W, const Vector& springs) {
  const Eigen::Index interior = A_.rows() - Eigen::Index(fixed.size());
  fixed_ = fixed;
  truncated_ = A_;
  truncated_.diagonal().tail(springs.size()) += springs;
  for (const TangentialStiffness& w : W) truncated_.block<2, 2>(w.first, w.first) += w.M;
  for (std::size_t c = 0; c < fixed.size(); ++c) {
    if (!fixed[c]) continue;
    truncated_.row(interior + Eigen::Index(c)).setZero();
    truncated_.col(interior + Eigen::Index(c)).setZero();
  }
  solver_.factor(truncated_, shift);
}

void DenseHierarchy::apply(const Vector& r, Vector& z) {
  z = r;
  solver_.solve(z);
  drop_fixed(fixed_, z);
}

double DenseHierarchy::bytes() const {
  return 2.0 * sizeof(Real) * double(A_.size()) + solver_.bytes();
}

}  // namespace frictioncg
