#include "assembly/slippable.h"

#include <algorithm>
#include <cmath>

#include "linear_algebra.h"

namespace frictioncg {

namespace {

using Vec3 = Eigen::Vector3d;
using Fields = Eigen::Matrix<Real, 3, Eigen::Dynamic, 0, 3, 6>;
using Square = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

/// A point that moves by less than this share of the mean motion is on the axis, where the motion
/// has no direction.
constexpr Real at_rest = 0.05;
/// A normal is made orthogonal to a motion only where this share of it is left.
constexpr Real kept = 0.9;

/// The generators of rigid motions, about the centre and over the extent of the points.
class Motions {
 public:
  Motions(int d, const std::vector<PointNormal>& points, const SumOverProcesses& sum)
      : d_(d), count_(d == 2 ? 3 : 6) {
    Real of_all[5] = {0, 0, 0, 0, 0};
    for (const PointNormal& p : points) {
      for (int c = 0; c < 3; ++c) of_all[c] += p.weight * p.x[c];
      of_all[3] += p.weight;
      of_all[4] += p.weight * std::pow(p.turn, 4);
    }
    if (sum) sum(of_all, 5);
    total_ = of_all[3];
    if (!(total_ > 0)) return;
    centre_ = Vec3(of_all[0], of_all[1], of_all[2]) / total_;
    allowed_ = of_all[4] / (16 * total_);
    Real inertia = 0;
    for (const PointNormal& p : points) inertia += p.weight * (p.x - centre_).squaredNorm();
    if (sum) sum(&inertia, 1);
    size_ = std::sqrt(inertia / total_);
  }
  bool any() const { return allowed_ > 0 && size_ > 0; }
  Index count() const { return count_; }
  Real total() const { return total_; }
  Real allowed() const { return allowed_; }  ///< mean square of n.w over that of w

  Fields at(const Vec3& x) const {
    const Vec3 arm = (x - centre_) / size_;
    Fields w = Fields::Zero(3, count_);
    w.leftCols(d_).topRows(d_).setIdentity();
    for (int axis = d_ == 2 ? 2 : 0; axis < 3; ++axis)
      w.col(d_ == 2 ? 2 : 3 + axis) = Vec3::Unit(axis).cross(arm);
    return w;
  }

 private:
  const int d_;
  const Index count_;
  Real total_ = 0, allowed_ = 0, size_ = 0;
  Vec3 centre_ = Vec3::Zero();
};

/// The slippable motions, as columns of generators:   Q c = lambda M c,  lambda <= allowed,
/// Q = sum m (w'n)(w'n)',  M = sum m w'w.
Eigen::MatrixXd slippable(const Motions& motions, const std::vector<PointNormal>& points,
                          const SumOverProcesses& sum) {
  const Index k = motions.count();
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(k, 2 * k);
  for (const PointNormal& p : points) {
    const Fields w = motions.at(p.x);
    const Eigen::VectorXd g = w.transpose() * p.normal;
    both.leftCols(k) += p.weight * g * g.transpose();
    both.rightCols(k) += p.weight * w.transpose() * w;
  }
  if (sum) sum(both.data(), 2 * k * k);
  constexpr Real rounding = 1e-12;  // points on a line do not tell the rotation about it
  const Square Q = both.leftCols(k),
               M = both.rightCols(k) + rounding * motions.total() * Square::Identity(k, k);
  const Eigenpairs found = eigenpairs(Q, M);
  Index count = 0;
  while (count < k && found.values[count] <= motions.allowed()) ++count;
  return found.vectors.leftCols(count);
}

/// Takes off what a normal has along the directions in which motions move its point, the strongest
/// first: at most d - 1.
void make_tangential(int d, const Fields& w, Real mean, PointNormal& p) {
  const Eigenpairs along = eigenpairs(w * w.transpose());
  Vec3 n = p.normal;
  for (Index c = 2; c > 3 - d; --c) {
    if (along.values[c] < std::pow(at_rest * mean, 2)) break;
    const Vec3 u = along.vectors.col(c);
    n -= n.dot(u) * u;
  }
  if (n.norm() > kept) p.normal = n.normalized();
}

}  // namespace

int follow_slippable_motions(int d, std::vector<PointNormal>& points, const SumOverProcesses& sum) {
  const Motions motions(d, points, sum);
  if (!motions.any()) return 0;
  const Eigen::MatrixXd c = slippable(motions, points, sum);
  if (c.cols() == 0) return 0;
  const Real mean = 1 / std::sqrt(motions.total());  // c'Mc = 1
  for (PointNormal& p : points)
    if (p.turn > 0) make_tangential(d, motions.at(p.x) * c, mean, p);
  return static_cast<int>(c.cols());
}

}  // namespace frictioncg
