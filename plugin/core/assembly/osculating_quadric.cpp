#include "assembly/osculating_quadric.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Householder>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace frictioncg {

namespace {

using Vec3 = Eigen::Vector3d;

/// The vertices leave some of the curvature open where the least diagonal of R is below this share
/// of the largest; a third and twice of it do as well on random triangulations and single layers.
constexpr Real open = 1e-2;
/// The normal has arrived where the slope left in its frame is below this: rounding.
constexpr Real arrived = 1e-14;
/// Two curvatures are one where they differ by less than this share.
constexpr Real same = 1e-12;
/// 4 to 6 steps are usual, 30 are needed where the curvature is open.
constexpr int most_steps = 30;
/// A normal further from the mean one than 45 degrees (their cosine) is no normal of a surface.
constexpr Real leaning = M_SQRT1_2;

/// k of the principal curvatures of [c d; d f].
Real along_normal(Real c, Real d, Real f) {
  const Real mean = (c + f) / 2, deviation = std::hypot((c - f) / 2, d);
  const Real k1 = mean + deviation, k2 = mean - deviation, sum = std::abs(k1) + std::abs(k2);
  return sum > 0 ? (k1 * std::abs(k1) + k2 * std::abs(k2)) / sum : 0;
}

/// Fits   z = a x + b y + (c x^2 + 2 d x y + f y^2 + k z^2)/2   with weights |e|^-2, turns the axes
/// until a = b = 0, and takes k from the step before. Lengths are over that of the farthest point.
/// Of curvature that the points leave open, beside a and b, it takes the least, or what develops.
class Fit {
 public:
  Fit(int d, const std::vector<Vec3>& points)
      : d_(d),
        points_(points),
        slopes_(points.size(), d - 1),
        bends_(points.size(), d == 2 ? 1 : 3),
        right_(points.size()) {
    for (const Vec3& e : points) size_ = std::max(size_, e.norm());
    solver_.setThreshold(open);
  }
  std::optional<Quadric> from(const Vec3& mean) {
    n_ = mean;
    s1_ = mean.unitOrthogonal();
    for (int step = 0; step < most_steps; ++step) {
      set_axes();
      const Real before = k_;
      const Vector slope = solve();
      n_ -= slope[0] * s1_;
      if (d_ == 3) n_ -= slope[1] * s2_;
      n_.normalize();
      if (!(n_.dot(mean) > leaning)) return {};
      if (slope.lpNorm<1>() < arrived && std::abs(k_ - before) < same) break;
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
  void set_rows() {
    for (Index j = 0; j < right_.size(); ++j) {
      const Vec3 e = points_[j] / size_;
      const Real x = e.dot(s1_), y = e.dot(s2_), z = e.dot(n_), weight = 1 / e.squaredNorm();
      if (d_ == 2) {
        slopes_(j, 0) = weight * x;
        bends_(j, 0) = weight * x * x / 2;
      } else {
        slopes_.row(j) << weight * x, weight * y;
        bends_.row(j) << weight * x * x / 2, weight * x * y / M_SQRT2, weight * y * y / 2;
      }
      right_[j] = weight * (z - k_ * z * z / 2);
    }
  }
  /// Finds the curvature by what is orthogonal to the slopes; returns these.
  Vector solve() {
    set_rows();
    const Index s = slopes_.cols(), rest = std::max<Index>(right_.size() - s, 0);
    qr_.compute(slopes_);
    bends_.applyOnTheLeft(qr_.householderQ().adjoint());
    right_.applyOnTheLeft(qr_.householderQ().adjoint());
    q_.setZero(bends_.cols());
    if (rest > 0) q_ = solver_.compute(bends_.bottomRows(rest)).solve(right_.tail(rest));
    if (d_ == 3 && rest > 0 && solver_.rank() == 2) develop(bends_.bottomRows(rest));
    k_ = d_ == 2 ? q_[0] : along_normal(q_[0], q_[1] / M_SQRT2, q_[2]);
    return qr_.matrixQR().topRows(s).triangularView<Eigen::Upper>().solve(
        Vector(right_.head(s) - bends_.topRows(s) * q_));
  }
  /// Two rows of vertices leave one curvature open: that which makes c f = d^2, as on a cylinder or
  /// a cone. q + t v, v what is open.
  void develop(const Eigen::MatrixXd& rows) {
    const Eigen::Matrix3d normal_equations = rows.transpose() * rows;
    const Vec3 v =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(normal_equations).eigenvectors().col(0);
    const Real two = v[0] * v[2] - v[1] * v[1] / 2, zero = q_[0] * q_[2] - q_[1] * q_[1] / 2;
    const Real one = q_[0] * v[2] + q_[2] * v[0] - q_[1] * v[1], root = one * one - 4 * two * zero;
    if (!(root >= 0) || one == 0) return;
    q_ -= 2 * zero / (one + std::copysign(std::sqrt(root), one)) * v;
  }
  Quadric quadric() const {
    Quadric found;
    found.normal = n_;
    found.k = k_ / size_;
    found.curvature = q_[0] * s1_ * s1_.transpose();
    if (d_ == 3)
      found.curvature += q_[1] / M_SQRT2 * (s1_ * s2_.transpose() + s2_ * s1_.transpose()) +
                         q_[2] * s2_ * s2_.transpose();
    found.curvature /= size_;
    return found;
  }

  const int d_;
  const std::vector<Vec3>& points_;
  Real size_ = 0, k_ = 0;
  Vec3 n_, s1_, s2_;
  Eigen::MatrixXd slopes_, bends_;
  Vector right_, q_;  ///< q: c, sqrt(2) d, f; 2D: c
  Eigen::HouseholderQR<Eigen::MatrixXd> qr_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver_;
};

}  // namespace

std::optional<Quadric> osculating_quadric(int d, const std::vector<Vec3>& around,
                                          const Vec3& mean) {
  return Fit(d, around).from(mean);
}

}  // namespace frictioncg
