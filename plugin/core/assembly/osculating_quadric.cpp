#include "assembly/smooth_normals.h"
#include "linear_algebra.h"

namespace frictioncg {

namespace {

/// The vertices leave some of the curvature open where the least diagonal of R is below this share
/// of the largest; a third and twice of it do as well on random triangulations and single layers.
/// Two circles of a cone leave the last open, but for how they lean: they are those of a sphere,
/// too.
constexpr Real open = 1e-2, last_open = 6e-2;
/// The normal has arrived where the slope left in its frame is below this: rounding.
constexpr Real arrived = 1e-14;
/// Two curvatures are one where they differ by less than this share.
constexpr Real settled = 1e-12;
/// 4 to 6 steps are usual, 30 are needed where the curvature is open.
constexpr int most_steps = 30;

/// k of the principal curvatures of [c d; d f].
Real along_normal(Real c, Real d, Real f) {
  const Real mean = (c + f) / 2, deviation = std::hypot((c - f) / 2, d);
  const Real k1 = mean + deviation, k2 = mean - deviation, sum = std::abs(k1) + std::abs(k2);
  return sum > 0 ? (k1 * std::abs(k1) + k2 * std::abs(k2)) / sum : 0;
}

/// Fits   z = a x + b y + (c x^2 + 2 d x y + f y^2 + k z^2)/2   with weights |e|^-2, turns the axes
/// until a = b = 0, and takes k from the step before. Lengths are over that of the farthest point.
/// Where the points leave some of the curvature open, the fit takes the least curvature, or a
/// developable surface.
template <int d>
class Fit {
 public:
  Fit(const std::vector<Vec3>& points, Told told)
      : points_(points), moves_(told.moves), known_(told.strip && d == 3 ? 2 : bends) {
    for (const Vec3& e : points) size_ = std::max(size_, e.norm());
  }
  std::optional<Quadric> from(const Vec3& mean) {
    n_ = mean;
    s1_ = mean.unitOrthogonal();
    for (int step = 0; step < most_steps; ++step) {
      set_axes();
      const Real before = k_;
      solve();
      const auto slope = found_.template head<slopes>();
      n_ -= slope[0] * s1_;
      if constexpr (d == 3) n_ -= slope[1] * s2_;
      n_.normalize();
      if (!(n_.dot(mean) > leaning)) return {};
      if (slope.template lpNorm<1>() < arrived && std::abs(k_ - before) < settled) break;
    }
    return quadric();
  }

 private:
  static constexpr int slopes = d - 1, bends = d == 2 ? 1 : 3, unknowns = slopes + bends;
  using Bends = Eigen::Matrix<Real, bends, bends>;
  static constexpr int some = 8;  ///< points at once: a column of them fits vector registers

  /// The first tangent turns with the normal: the curvature of the step before keeps its meaning.
  void set_axes() {
    if (d == 2) s1_ = Vec3::UnitZ().cross(n_);
    if (d == 3) s1_ = (s1_ - s1_.dot(n_) * n_).normalized();
    s2_ = n_.cross(s1_);
  }
  /// What the fit says of one point: factors of the unknowns, and the right side.
  Eigen::Matrix<Real, 1, unknowns + 1> row_of(const Vec3& point) const {
    const Vec3 e = point / size_;
    const Real x = e.dot(s1_), y = e.dot(s2_), z = e.dot(n_), right = z - k_ * z * z / 2;
    Eigen::Matrix<Real, 1, unknowns + 1> row;
    if constexpr (d == 2) row << x, x * x / 2, right;
    if constexpr (d == 3) row << x, y, x * x / 2, x * y / M_SQRT2, y * y / 2, right;
    return row / e.squaredNorm();
  }
  /// R of the rows of all points, with their right sides turned along, by Householder reflections.
  void triangulate() {
    R_.setZero();
    for (std::size_t j = 0; j < points_.size();) {
      rows_.setZero();
      for (int i = 0; i < some && j < points_.size(); ++i) rows_.row(i) = row_of(points_[j++]);
      for (int c = 0; c < unknowns; ++c) {
        const Real before = R_(c, c), rest = rows_.col(c).squaredNorm();
        if (rest == 0) continue;
        R_(c, c) = -std::copysign(std::sqrt(before * before + rest), before);
        const Real head = before - R_(c, c), factor = 1 / (R_(c, c) * head);
        for (int l = c + 1; l <= unknowns; ++l) {
          const Real part = factor * (head * R_(c, l) + rows_.col(c).dot(rows_.col(l)));
          R_(c, l) += part * head;
          rows_.col(l) += part * rows_.col(c);
        }
      }
    }
  }
  /// Finds slopes and curvature. What R has of curvature alone is orthogonal to the slopes.
  void solve() {
    triangulate();
    const int rest = std::clamp(static_cast<int>(points_.size()) - slopes, 0, bends);
    Bends rows = R_.template block<bends, bends>(slopes, slopes);
    rows.bottomRows(bends - rest).setZero();  // of no point
    const auto right_side = R_.template block<bends, 1>(slopes, unknowns);
    const auto [rank, between] = rank_of(rows, known_);
    const bool apart = rank < bends || moves_;
    if (moves_) {
      found_.template tail<bends>() = without_a_jump(rows, right_side);
    } else if (apart) {
      found_.template tail<bends>() = least_squares(rows, right_side, between);
      if (d == 3 && rank == 2) develop(rows);
    }
    for (int k = (apart ? slopes : unknowns) - 1; k >= 0; --k) {
      Real right = R_(k, unknowns);
      for (int l = k + 1; l < unknowns; ++l) right -= R_(k, l) * found_[l];
      found_[k] = right / R_(k, k);
    }
    q_.head<bends>() = found_.template tail<bends>();
    k_ = along_normal(q_[0], q_[1] / M_SQRT2, q_[2]);
  }
  /// The curvature of a surface that moves: what the vertices tell of it fades out, as they leave
  /// it open, by the singular values s of the rows over all of them,
  ///   q = sum_i ramp(s_i) (v_i.R'r) / s_i^2 v_i
  static Eigen::Matrix<Real, bends, 1> without_a_jump(const Bends& rows, const Vector& right) {
    constexpr Real none = 0.03, all = 0.1;
    const Eigenpairs of = eigenpairs(rows.transpose() * rows);
    const Vector along = of.vectors.transpose() * (rows.transpose() * right);
    Vector found = Vector::Zero(bends);
    for (int i = 0; i < bends; ++i) {
      const Real share = std::sqrt(std::max<Real>(0, of.values[i] / of.values.sum()));
      const Real t = std::clamp<Real>((share - none) / (all - none), 0, 1);
      if (t > 0) found += t * t * (3 - 2 * t) * along[i] / of.values[i] * of.vectors.col(i);
    }
    return found;
  }
  /// By what each column adds to those before, the largest first; and a share of the largest
  /// between that of the last which counts and the next.
  static std::pair<int, Real> rank_of(Bends rows, int known) {
    Real first = 0, last = 0;
    for (int rank = 0; rank < bends; ++rank) {
      int largest = 0;
      for (int c = 1; c < bends; ++c)
        if (rows.col(c).squaredNorm() > rows.col(largest).squaredNorm()) largest = c;
      const Real size = rows.col(largest).norm();
      if (rank == 0) first = size;
      if (rank == known || !(size > (rank == 2 ? last_open : open) * first))
        return {rank, std::sqrt(last * size) / first};
      last = size;
      const Eigen::Matrix<Real, bends, 1> direction = rows.col(largest) / size;
      rows -= direction * (direction.transpose() * rows);
    }
    return {bends, 0};
  }
  /// Two rows of vertices leave one curvature open: that which makes c f = d^2, as on a cylinder or
  /// a cone. q + t v, v what is open.
  void develop(const Bends& rows) {
    auto q = found_.template tail<bends>();
    const auto v = eigenpairs(rows.transpose() * rows).vectors.col(0).eval();
    const Real two = v[0] * v[2] - v[1] * v[1] / 2, zero = q[0] * q[2] - q[1] * q[1] / 2;
    const Real one = q[0] * v[2] + q[2] * v[0] - q[1] * v[1], root = one * one - 4 * two * zero;
    if (!(root >= 0) || one == 0) return;
    q -= 2 * zero / (one + std::copysign(std::sqrt(root), one)) * v;
  }
  Quadric quadric() const {
    Quadric found;
    found.normal = n_;
    found.k = k_ / size_;
    found.curvature = (q_[0] * s1_ * s1_.transpose() + q_[2] * s2_ * s2_.transpose() +
                       q_[1] / M_SQRT2 * (s1_ * s2_.transpose() + s2_ * s1_.transpose())) /
                      size_;
    return found;
  }

  const std::vector<Vec3>& points_;
  const bool moves_;
  const int known_;  ///< of the curvature, at most
  Real size_ = 0, k_ = 0;
  Vec3 n_, s1_, s2_;
  Eigen::Matrix<Real, unknowns, unknowns + 1> R_;
  Eigen::Matrix<Real, some, unknowns + 1> rows_;
  Eigen::Matrix<Real, unknowns, 1> found_;
  Vec3 q_ = Vec3::Zero();  ///< c, sqrt(2) d, f; 2D: c, 0, 0
};

}  // namespace

std::optional<Quadric> osculating_quadric(int d, const std::vector<Vec3>& around, const Vec3& mean,
                                          Told told) {
  return d == 2 ? Fit<2>(around, told).from(mean) : Fit<3>(around, told).from(mean);
}

}  // namespace frictioncg
