#include "condensed/equilibrium.h"

#include <algorithm>
#include <cmath>

namespace frictioncg {

namespace {

constexpr Index most_rigid_motions = 6;
constexpr Real shift = 1e-9;   ///< of inverse iteration, relative to D
constexpr Real rigid = 1e-11;  ///< <Sw,w>/<Dw,w> of a rigid motion
constexpr Real held = 1e-9;    ///< f.w over |f||w| at which the load counts as balanced

/// Motions of the contact dofs that cost no energy, D-orthonormal, by inverse iteration on S +
/// shift D.
DenseMatrix rigid_motions(const DenseMatrix& S) {
  const Index n = static_cast<Index>(S.rows()), most = std::min(n, most_rigid_motions);
  const Vector D = S.diagonal().cwiseMax(1e-300);
  const Vector scale = D.cwiseSqrt().cwiseInverse();
  DenseMatrix M = scale.asDiagonal() * S * scale.asDiagonal();
  M.diagonal().array() += shift;
  const Eigen::LLT<DenseMatrix> factor(M);
  if (factor.info() != Eigen::Success) return DenseMatrix(n, 0);
  DenseMatrix W(n, most);
  for (Index j = 0; j < most; ++j)  // any start that is not special
    for (Index i = 0; i < n; ++i) W(i, j) = std::cos(1.0 + i * (j + 1.37) + 0.7 * j);
  for (int k = 0; k < 4; ++k) {
    W = factor.solve(W);
    W = Eigen::HouseholderQR<DenseMatrix>(W).householderQ() * DenseMatrix::Identity(n, most);
  }
  M.diagonal().array() -= shift;
  const Eigen::SelfAdjointEigenSolver<DenseMatrix> ritz(W.transpose() * M * W);
  Index count = 0;
  while (count < most && ritz.eigenvalues()[count] <= rigid) ++count;
  return scale.asDiagonal() * (W * ritz.eigenvectors().leftCols(count));
}

/// Nonnegative least squares over a growing set of columns (Lawson and Hanson): the point of their
/// cone nearest to the target.
class NearestInCone {
 public:
  explicit NearestInCone(const Vector& target) : target_(target), rest_(target) {}

  const Vector& rest() const { return rest_; }  ///< target - nearest point

  void add(const Vector& column) {
    columns_.push_back(column);
    weight_.push_back(0);
    for (std::size_t pass = 0; pass < 2 * columns_.size() + 2; ++pass) {
      const Vector best = least_squares();
      Real step = 1;
      for (std::size_t k = 0; k < columns_.size(); ++k)
        if (best[k] <= 0 && weight_[k] > best[k])
          step = std::min(step, weight_[k] / (weight_[k] - best[k]));
      const bool whole = step == 1 && (best.array() > 0).all();
      for (std::size_t k = columns_.size(); k-- > 0;) {
        weight_[k] += step * (best[k] - weight_[k]);
        if (whole || weight_[k] > 1e-14 * (1 + std::abs(best[k]))) continue;
        weight_.erase(weight_.begin() + k);
        columns_.erase(columns_.begin() + k);
      }
      if (whole || columns_.empty()) break;
    }
    rest_ = target_;
    for (std::size_t k = 0; k < columns_.size(); ++k) rest_ -= weight_[k] * columns_[k];
  }

 private:
  Vector least_squares() const {
    DenseMatrix G(target_.size(), columns_.size());
    for (std::size_t k = 0; k < columns_.size(); ++k) G.col(k) = columns_[k];
    return G.completeOrthogonalDecomposition().solve(target_);
  }
  Vector target_, rest_;
  std::vector<Vector> columns_;
  std::vector<Real> weight_;
};

}  // namespace

bool cannot_be_held(const CondensedProblem& condensed) {
  const ContactProblem& laws = condensed.laws;
  if (laws.increment.law == Law::tresca) return false;
  const DenseMatrix W = rigid_motions(condensed.S);
  if (W.cols() == 0) return false;
  const Vector works = W.transpose() * condensed.f;
  const Real forces = condensed.f.cwiseAbs().sum();
  NearestInCone nearest(works);
  for (int k = 0; k < 1000; ++k) {
    const Vector w = W * nearest.rest();
    const Real work = condensed.f.dot(w), size = w.cwiseAbs().maxCoeff();
    if (work <= held * forces * size) return false;
    // the force of a friction cone that resists w most
    Real most = 0;
    Vector column;
    for (Index i = 0; i < laws.nodes(); ++i) {
      if (!std::isfinite(laws.increment.gap[i])) continue;
      const Index N = condensed.normal(i), t = laws.tangents(i);
      const Real slide = w.segment(N + 1, t).norm();
      const Real mu = laws.increment.law == Law::coulomb ? laws.increment.mu[i] : 0;
      const Real sense = laws.increment.bilateral && w[N] < 0 ? -1 : 1;
      const Real resistance = sense * w[N] + mu * slide;
      if (resistance <= most) continue;
      most = resistance;
      column = sense * W.row(N).transpose();
      if (slide > 0)
        column += mu / slide * (W.middleRows(N + 1, t).transpose() * w.segment(N + 1, t));
    }
    // pressures would have to exceed the load a hundred times for what resists to balance it
    if (100 * most * forces <= work) return true;
    nearest.add(column);
  }
  return false;
}

}  // namespace frictioncg
