#include "assembly/osculating_quadric.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace frictioncg {

namespace {

using Vec3 = Eigen::Vector3d;

/// Least over largest diagonal of R below which the first ring says too little: half and twice of
/// it do as well on random triangulations.
constexpr Real well_posed = 0.02;
/// The same, below which the vertices of both rings leave it open; 5e-3 does as well, 1e-4 does
/// not.
constexpr Real open = 1e-3;
constexpr Real arrived = 1e-14;      ///< slope: rounding
constexpr Real same = 1e-12;         ///< curvature
constexpr int most_steps = 30;       ///< 4 to 6 are usual, 30 where the curvature is open
constexpr Real leaning = M_SQRT1_2;  ///< cosine from the mean normal beyond which it is no surface

/// k of the principal curvatures of [c d; d f].
Real along_normal(Real c, Real d, Real f) {
  const Real mean = (c + f) / 2, deviation = std::hypot((c - f) / 2, d);
  const Real k1 = mean + deviation, k2 = mean - deviation, sum = std::abs(k1) + std::abs(k2);
  return sum > 0 ? (k1 * std::abs(k1) + k2 * std::abs(k2)) / sum : 0;
}

/// Fits   z = a x + b y + (c x^2 + 2 d x y + f y^2 + k z^2)/2   with weights |e|^-2, turns the axes
/// until a = b = 0, and takes k from the step before. Lengths are over that of the farthest point.
/// Of what the points leave open it takes the least.
class Fit {
 public:
  Fit(int d, const std::vector<Vec3>& points, Real threshold)
      : d_(d), points_(points), M_(points.size(), d == 2 ? 2 : 5), right_(points.size()) {
    for (const Vec3& e : points) size_ = std::max(size_, e.norm());
    solver_.setThreshold(threshold);
  }
  std::optional<Quadric> from(const Vec3& mean, bool may_be_open) {
    n_ = mean;
    s1_ = mean.unitOrthogonal();
    for (int step = 0; step < most_steps; ++step) {
      set_axes();
      const Real before = k_;
      solve();
      if (!may_be_open && solver_.rank() < M_.cols()) return {};
      const Real a = q_[0], b = d_ == 2 ? 0 : q_[1];
      n_ = (n_ - a * s1_ - b * s2_).normalized();
      if (!(n_.dot(mean) > leaning)) return {};
      if (std::abs(a) + std::abs(b) < arrived && std::abs(k_ - before) < same) break;
    }
    return quadric();
  }

 private:
  /// The first tangent turns with the normal: the curvature of the step before keeps its meaning.
  void set_axes() {
    if (d_ == 2) s1_ = Vec3::UnitZ().cross(n_);
    if (d_ == 3) s1_ = (s1_ - s1_.dot(n_) * n_).normalized();
    s2_ = n_.cross(s1_);
  }
  void solve() {
    for (Index j = 0; j < M_.rows(); ++j) {
      const Vec3 e = points_[j] / size_;
      const Real x = e.dot(s1_), y = e.dot(s2_), z = e.dot(n_), weight = 1 / e.squaredNorm();
      if (d_ == 2)
        M_.row(j) << x, x * x / 2;
      else
        M_.row(j) << x, y, x * x / 2, x * y / M_SQRT2, y * y / 2;
      M_.row(j) *= weight;
      right_[j] = weight * (z - k_ * z * z / 2);
    }
    q_ = solver_.compute(M_).solve(right_);
    k_ = d_ == 2 ? q_[1] : along_normal(q_[2], q_[3] / M_SQRT2, q_[4]);
  }
  Quadric quadric() const {
    Quadric found;
    found.normal = n_;
    found.k = k_ / size_;
    found.curvature = (d_ == 2 ? q_[1] : q_[2]) * s1_ * s1_.transpose();
    if (d_ == 3)
      found.curvature += q_[3] / M_SQRT2 * (s1_ * s2_.transpose() + s2_ * s1_.transpose()) +
                         q_[4] * s2_ * s2_.transpose();
    found.curvature /= size_;
    return found;
  }

  const int d_;
  const std::vector<Vec3>& points_;
  Real size_ = 0, k_ = 0;
  Vec3 n_, s1_, s2_;
  Eigen::MatrixXd M_;
  Vector right_, q_;  ///< q: a, b, c, sqrt(2) d, f; 2D: a, c
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver_;
};

}  // namespace

std::optional<Quadric> osculating_quadric(int d, const std::vector<Vec3>& ring,
                                          const std::vector<Vec3>& second, bool rim,
                                          const Vec3& mean) {
  std::optional<Quadric> found;
  if (!rim) found = Fit(d, ring, well_posed).from(mean, false);
  if (found) return found;
  std::vector<Vec3> both = ring;
  both.insert(both.end(), second.begin(), second.end());
  return Fit(d, both, open).from(mean, true);
}

}  // namespace frictioncg
