#include "assembly/mortar/turning_normal.h"

#include "assembly/mortar/smooth_side.h"

namespace frictioncg::mortar {

namespace {

Mat3 cross(const Vec3& a) {
  Mat3 m;
  m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return m;
}

/// Of e / |e|^2.
Mat3 slope_of_inverse(const Vec3& e) {
  const Real square = e.squaredNorm();
  return (Mat3::Identity() - 2 / square * e * e.transpose()) / square;
}

}  // namespace

void TurningNormal::add(const Side& side, Index f) {
  if (side.planes[f].normal.dot(n_) < sharp) return;
  const auto& node = side.facet(f).node;
  const int v = position(side.facet(f), i_);
  const Index j = node[(v + 1) % side.d], k = node[(v + 2) % side.d];
  const Vec3 e = X_[j] - X_[i_];
  ++facets_, facet_ = f, beside_ = j;
  if (side.d == 2) return add(e, Vec3::UnitZ(), j, side.planes[f].normal);
  add(e, (X_[k] - X_[i_]) / (X_[k] - X_[i_]).squaredNorm(), j, side.planes[f].normal);
  const Mat3 by = sign_ * cross(e / e.squaredNorm()) * slope_of_inverse(X_[k] - X_[i_]);
  slope(k) += by;
  slope(i_) -= by;
}

void TurningNormal::end(const Side& side, const std::vector<char>& smooth) {
  if (side.d == 3 || facets_ != 1) return;
  for (std::size_t k = 0; k < side.joints.size(); ++k) {
    const auto [f, g] = side.joints[k].facet;
    if (!is_smooth(side, k, smooth) || side.joints[k].vertex[0] != beside_) continue;
    if (f != facet_ && g != facet_) continue;
    const auto& node = side.facet(f == facet_ ? g : f).node;
    const Index farther = node[0] == beside_ ? node[1] : node[0];
    add(X_[farther] - X_[i_], Vec3::UnitZ(), farther, side.planes[facet_].normal, -1);
  }
}

/// factor e/|e|^2 x other, whose sign without the factor is that of n_f
void TurningNormal::add(const Vec3& e, const Vec3& other, Index j, const Vec3& n_f, Real factor) {
  const Vec3 term = (e / e.squaredNorm()).cross(other);
  sign_ = term.dot(n_f) < 0 ? -factor : factor;
  sum_ += sign_ * term;
  const Mat3 by = -sign_ * cross(other) * slope_of_inverse(e);
  slope(j) += by;
  slope(i_) -= by;
}

Turns TurningNormal::turns() const {
  Turns turns = slopes_;
  const Mat3 along = (Mat3::Identity() - n_ * n_.transpose()) / sum_.norm();
  for (auto& [j, by] : turns) by = along * by;
  return turns;
}

}  // namespace frictioncg::mortar
