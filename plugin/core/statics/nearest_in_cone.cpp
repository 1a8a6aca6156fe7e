#include "statics/nearest_in_cone.h"

#include <Eigen/Jacobi>

namespace frictioncg {

namespace {

/// A column leads to the target only where its cosine to it is above this.
constexpr Real no_descent = 1e-14;
/// What a unit column adds to those before it is nothing below this: rounding.
constexpr Real dependent = 1e-13;
/// A point is nearer, too, where it is as near to rounding: the distance goes with the square of
/// the angle between its normal and the cone, which is what a proof needs.
constexpr Real as_near = 1e-14;

}  // namespace

NearestInCone::NearestInCone(const Vector& target)
    : target_(target),
      rest_(target),
      G_(target.size(), target.size()),
      Q_(target.size(), target.size()),
      R_(target.size(), target.size()) {}

bool NearestInCone::add(const DenseMatrix& columns) {
  bool any = false;
  const Index all = static_cast<Index>(columns.cols());
  std::vector<char> failed(all, 0);
  for (Index pass = 0; pass <= all; ++pass) {
    Index best = all;
    Real steepest = no_descent * rest_.norm();
    for (Index k = 0; k < all; ++k) {
      if (failed[k]) continue;
      const auto column = columns.col(k);
      const Real size = column.norm(), slope = size > 0 ? column.dot(rest_) / size : 0;
      if (slope <= steepest) continue;
      steepest = slope;
      best = k;
    }
    if (best == all) break;
    const bool nearer = add_one(columns.col(best));
    failed[best] = !nearer;
    any = any || nearer;
  }
  return any;
}

bool NearestInCone::add_one(const Vector& column) {
  const Real before = rest_.norm();
  const DenseMatrix columns = G();
  const std::vector<Real> weight = weight_;
  if (!append(column.normalized(), 0)) return false;
  while (count() > 0 && !step()) {
  }
  const Vector rest = orthogonal_rest();
  if (rest.norm() <= (1 + as_near) * before) {
    const bool kept = count() > 0 && G_.col(count() - 1) == column.normalized();  // it is the last
    const bool nearer = kept || rest.norm() < before;
    rest_ = rest;
    return nearer;
  }
  weight_.clear();  // rounding
  for (std::size_t k = 0; k < weight.size(); ++k)
    append(columns.col(static_cast<Index>(k)), weight[k]);
  return false;
}

/// False where the columns that are there make it up. Gram and Schmidt, twice.
bool NearestInCone::append(Vector unit, Real weight) {
  const Index k = count();
  if (k == target_.size()) return false;
  G_.col(k) = unit;
  Vector along = Vector::Zero(k);
  for (int pass = 0; pass < 2; ++pass) {
    const Vector more = Q().transpose() * unit;
    unit -= Q() * more;
    along += more;
  }
  const Real left = unit.norm();
  if (!(left > dependent)) return false;
  Q_.col(k) = unit / left;
  R_.col(k).head(k) = along;
  R_(k, k) = left;
  weight_.push_back(weight);
  return true;
}

/// By plane rotations, which make R a triangle again.
void NearestInCone::remove(Index j) {
  const Index last = count() - 1;
  for (Index k = j; k < last; ++k) {
    G_.col(k) = G_.col(k + 1);
    R_.col(k).head(k + 2) = R_.col(k + 1).head(k + 2);
  }
  for (Index k = j; k < last; ++k) {
    Eigen::JacobiRotation<Real> turn;
    turn.makeGivens(R_(k, k), R_(k + 1, k));
    R_.middleCols(k, last - k).applyOnTheLeft(k, k + 1, turn.adjoint());
    Q_.applyOnTheRight(k, k + 1, turn);
  }
  weight_.erase(weight_.begin() + j);
}

/// Towards the least squares of the present columns, as far as the weights stay positive; drops
/// those that vanish. True where it got there.
bool NearestInCone::step() {
  const Vector best = R_.topLeftCorner(count(), count())
                          .triangularView<Eigen::Upper>()
                          .solve(Q().transpose() * target_);
  Real length = 1;
  Index first = count();
  for (Index k = 0; k < count(); ++k) {
    if (best[k] > 0) continue;
    const Real to_zero = weight_[k] > 0 ? weight_[k] / (weight_[k] - best[k]) : 0;
    if (first < count() && to_zero >= length) continue;
    length = to_zero;
    first = k;
  }
  for (Index k = 0; k < count(); ++k)
    weight_[k] = std::max(0.0, weight_[k] + length * (best[k] - weight_[k]));
  if (first == count()) return true;
  remove(first);
  return count() == 0;
}

/// target - nearest point, orthogonal to the columns to rounding of itself, not of the target: as
/// a proof it is as good as that.
Vector NearestInCone::orthogonal_rest() const {
  const Vector rest = target_ - G() * Eigen::Map<const Vector>(weight_.data(), count());
  return rest - Q() * (Q().transpose() * rest);
}

}  // namespace frictioncg
