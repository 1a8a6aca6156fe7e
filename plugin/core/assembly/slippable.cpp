#include "assembly/slippable.h"

namespace frictioncg {

namespace {

using Vec3 = Eigen::Vector3d;
using Fields = RigidGenerators::Fields;

/// A point that moves by less than this share of the mean motion is on the axis, where the motion
/// has no direction.
constexpr Real at_rest = 0.05;
/// A normal is made orthogonal to a motion only where this share of it is left.
constexpr Real kept = 0.9;
/// Points resist a motion clearly where the mean square of n.w is above this multiple of what is
/// allowed: normals would turn by ten times what the mesh cannot tell. Any two points of an oval
/// let a motion slip, which all of the oval resists.
constexpr Real clearly = 100;

/// The points, weighted.
struct Spread {
  Spread(const std::vector<PointNormal>& points, const SumOverProcesses& sum) {
    Real of_all[5] = {0, 0, 0, 0, 0};
    for (const PointNormal& p : points) {
      for (int c = 0; c < 3; ++c) of_all[c] += p.weight * p.x[c];
      of_all[3] += p.weight;
      of_all[4] += p.weight * std::pow(p.turn, 4);
    }
    if (sum) sum(of_all, 5);
    total = of_all[3];
    if (!(total > 0)) return;
    centre = Vec3(of_all[0], of_all[1], of_all[2]) / total;
    allowed = of_all[4] / (16 * total);
    Real inertia = 0;
    for (const PointNormal& p : points) inertia += p.weight * (p.x - centre).squaredNorm();
    if (sum) sum(&inertia, 1);
    size = std::sqrt(inertia / total);
  }
  Real total = 0, size = 0;
  Real allowed = 0;  ///< mean square of n.w over that of w
  Vec3 centre = Vec3::Zero();
};

/// Takes off what a normal has along the directions in which motions move its point, the strongest
/// first: at most d - 1.
void make_tangential(int d, const Fields& w, Real least, PointNormal& p) {
  const Eigenpairs along = eigenpairs(w * w.transpose());
  Vec3 n = p.normal;
  for (Index c = 2; c > 3 - d; --c) {
    if (along.values[c] < at_rest * at_rest) break;
    const Vec3 u = along.vectors.col(c);
    n -= n.dot(u) * u;
  }
  if (n.norm() > least) p.normal = n.normalized();
}

}  // namespace

Fields RigidGenerators::at(const Vec3& x) const {
  const Vec3 arm = (x - centre_) / size_;
  Fields w = Fields::Zero(3, count());
  w.leftCols(d_).topRows(d_).setIdentity();
  for (int axis = d_ == 2 ? 2 : 0; axis < 3; ++axis)
    w.col(d_ == 2 ? 2 : 3 + axis) = Vec3::Unit(axis).cross(arm);
  return w;
}

DenseMatrix tangential_motions(const RigidGenerators& generators, const DenseMatrix& V,
                               const std::vector<PointNormal>& points, Real allowed,
                               DecidedCount decided, const SumOverProcesses& sum) {
  const Index k = static_cast<Index>(V.cols());
  DenseMatrix both = DenseMatrix::Zero(k, 2 * k + 1);  // Q, M and the weight
  for (const PointNormal& p : points) {
    const DenseMatrix w = generators.at(p.x) * V;
    const Vector g = w.transpose() * p.normal;
    both.leftCols(k) += p.weight * g * g.transpose();
    both.middleCols(k, k) += p.weight * w.transpose() * w;
    both(0, 2 * k) += p.weight;
  }
  if (sum) sum(both.data(), static_cast<Index>(both.size()));
  constexpr Real rounding = 1e-12;  // points on a line do not tell the rotation about it
  const Real total = both.middleCols(k, k).trace();
  const DenseMatrix M = both.middleCols(k, k) + rounding * total * DenseMatrix::Identity(k, k);
  if (!(total > 0)) return DenseMatrix(V.rows(), 0);
  const Eigenpairs found = eigenpairs(both.leftCols(k), M);
  const Real bound = decided ? clearly * allowed : allowed;
  const Index most = decided.value_or(k);
  Index count = 0;
  while (count < std::min(k, most) && found.values[count] <= bound) ++count;
  return std::sqrt(both(0, 2 * k)) * V * found.vectors.leftCols(count);
}

void make_tangential(int d, const RigidGenerators& generators, const DenseMatrix& motions,
                     std::vector<PointNormal>& points, Real least) {
  for (PointNormal& p : points)
    if (motions.cols() > 0 && p.turn > 0)
      make_tangential(d, generators.at(p.x) * motions, least, p);
}

Index follow_slippable_motions(int d, std::vector<PointNormal>& points, DecidedCount decided,
                               const SumOverProcesses& sum) {
  const Spread spread(points, sum);
  if (!(spread.allowed > 0 && spread.size > 0)) return 0;
  const RigidGenerators generators(d, spread.centre, spread.size);
  const Index k = generators.count();
  const DenseMatrix c = tangential_motions(generators, DenseMatrix::Identity(k, k), points,
                                           spread.allowed, decided, sum);
  make_tangential(d, generators, c, points, kept);
  return static_cast<Index>(c.cols());
}

}  // namespace frictioncg
