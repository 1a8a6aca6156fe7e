#include "assembly/slippable.h"

namespace frictioncg {

namespace {

/// Normals tell an axis up to their errors: a point that moves by less than this may lie on it.
constexpr Tangential to_slippable{0.05, 0.9};
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
      of_all[4] += p.weight * untold(p.turn);
    }
    if (sum) sum(of_all, 5);
    total = of_all[3];
    if (!(total > 0)) return;
    centre = Vec3(of_all[0], of_all[1], of_all[2]) / total;
    allowed = of_all[4] / total;
    Real inertia = 0;
    for (const PointNormal& p : points) inertia += p.weight * (p.x - centre).squaredNorm();
    if (sum) sum(&inertia, 1);
    size = std::sqrt(inertia / total);
  }
  Real total = 0, size = 0;
  Real allowed = 0;  ///< mean square of n.w over that of w
  Vec3 centre = Vec3::Zero();
};

/// How motions V (generators x k) slip along the points: the c of Q c = lambda M c.
struct Slip {
  Slip(const RigidGenerators& generators, const DenseMatrix& V,
       const std::vector<PointNormal>& points, const SumOverProcesses& sum) {
    const Index k = static_cast<Index>(V.cols());
    if (k == 0) return;
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
    if (!(total > 0)) return;
    weight = both(0, 2 * k);
    found = eigenpairs(both.leftCols(k),
                       both.middleCols(k, k) + rounding * total * DenseMatrix::Identity(k, k));
  }
  Index count() const { return static_cast<Index>(found.values.size()); }
  /// The first of them, with a mean square of 1.
  DenseMatrix motions(const DenseMatrix& V, Index first) const {
    if (first == 0) return DenseMatrix(V.rows(), 0);
    return std::sqrt(weight) * V * found.vectors.leftCols(first);
  }
  Eigenpairs found;
  Real weight = 0;
};

/// An orthonormal basis of what motions span: two bodies have more motions between them than there
/// are, and of columns that depend on each other every combination that is 0 would slip.
DenseMatrix basis_of(DenseMatrix motions) {
  constexpr Real told_apart = 1e-10;  // square of what A leaves unknown of a motion
  motions.colwise().normalize();
  const Eigenpairs made = eigenpairs(motions * motions.transpose());
  return made.vectors.rightCols((made.values.array() > told_apart).count());
}

/// t.r of screws t + r x, between each two of them alike: 0 of rotations about axes that meet.
DenseMatrix pitch_of(const DenseMatrix& motions) {
  const DenseMatrix pitch = motions.bottomRows(3).transpose() * motions.topRows(3);
  return (pitch + pitch.transpose()) / 2;
}

/// Screws as the rotations about their axes: where all facets are cut alike, the errors of a
/// cone's normals have one sign, and a screw follows them, which the load along the axis drives.
/// Without columns where some of the motions hardly turn: those of a cylinder have any pitch.
/// motions: of a mean square of 1.
DenseMatrix without_pitch(const DenseMatrix& motions) {
  if (motions.rows() != rigid_components(3) || motions.cols() == 0) return DenseMatrix(0, 0);
  constexpr Real turning = 0.1;  // of the motion
  const DenseMatrix R = motions.bottomRows(3), RR = R.transpose() * R;
  if (eigenpairs(RR).values[0] < turning * turning) return DenseMatrix(0, 0);
  DenseMatrix rotations = motions;
  rotations.topRows(3) -= R * solve(RR, pitch_of(motions));
  return rotations;
}

/// Whether motions are combinations of those of V: what supports leave free may be a screw alone.
bool spans(const DenseMatrix& V, const DenseMatrix& motions) {
  constexpr Real rounding = 1e-9;
  return (V * least_squares(V, motions) - motions).norm() <= rounding * motions.norm();
}

}  // namespace

RigidGenerators::Fields RigidGenerators::at(const Vec3& x) const {
  const Vec3 arm = (x - centre_) / size_;
  Fields w = Fields::Zero(3, count());
  w.leftCols(d_).topRows(d_).setIdentity();
  for (int axis = d_ == 2 ? 2 : 0; axis < 3; ++axis)
    w.col(d_ == 2 ? 2 : 3 + axis) = Vec3::Unit(axis).cross(arm);
  return w;
}

Vector RigidGenerators::about(const Vec3& pivot, Index c) const {
  Vector motion = Vector::Unit(count(), c);
  if (c >= d_) motion.head(d_) -= at(pivot).col(c).head(d_);
  return motion;
}

DenseMatrix tangential_motions(const RigidGenerators& generators, const DenseMatrix& among,
                               const std::vector<PointNormal>& points, Real allowed,
                               DecidedSlips decided, const SumOverProcesses& sum) {
  const DenseMatrix V = basis_of(among);
  const Slip slip(generators, V, points, sum);
  const Real bound = decided ? clearly * allowed : allowed;
  const Index most = decided ? std::min(slip.count(), decided->count) : slip.count();
  Index count = 0;
  while (count < most && slip.found.values[count] <= bound) ++count;
  const DenseMatrix motions = slip.motions(V, count), rotations = without_pitch(motions);
  if (rotations.cols() == 0 || !spans(V, rotations)) return motions;
  const Slip turning(generators, rotations, points, sum);
  if (turning.count() < count) return motions;  // all points lie on the axis
  const bool slips = decided ? decided->rotations : turning.found.values[count - 1] <= allowed;
  return slips ? turning.motions(rotations, count) : motions;
}

Slips slips_of(const DenseMatrix& motions) {
  constexpr Real rounding = 1e-9;
  const bool turns = motions.rows() == rigid_components(3) && motions.cols() > 0;
  return {static_cast<Index>(motions.cols()), turns && pitch_of(motions).norm() < rounding, 0};
}

/// Takes off what a normal has along the directions in which motions move its point, the strongest
/// first: at most d - 1.
void make_tangential(int d, const RigidGenerators& generators, const DenseMatrix& motions,
                     std::vector<PointNormal>& points, Tangential where) {
  if (motions.cols() == 0) return;
  for (PointNormal& p : points) {
    if (p.turn == 0) continue;
    const DenseMatrix w = generators.at(p.x) * motions;
    const Eigenpairs along = eigenpairs(w * w.transpose());
    Vec3 n = p.normal;
    for (Index c = 2; c > 3 - d; --c) {
      if (along.values[c] < where.moved * where.moved) break;
      const Vec3 u = along.vectors.col(c);
      n -= n.dot(u) * u;
    }
    if (n.norm() > where.kept) p.normal = n.normalized();
  }
}

Slips follow_slippable_motions(int d, std::vector<PointNormal>& points, DecidedSlips decided,
                               const SumOverProcesses& sum) {
  const Spread spread(points, sum);
  if (!(spread.allowed > 0 && spread.size > 0)) return {};
  const RigidGenerators generators(d, spread.centre, spread.size);
  const Index k = generators.count();
  const DenseMatrix c = tangential_motions(generators, DenseMatrix::Identity(k, k), points,
                                           spread.allowed, decided, sum);
  make_tangential(d, generators, c, points, to_slippable);
  Slips slips = slips_of(c);
  if (slips.count > 0) slips.told = spread.allowed;
  return slips;
}

Slips follow_free_motions(int d, const RigidGenerators& generators, const DenseMatrix& V,
                          std::vector<PointNormal>& points, DecidedSlips decided,
                          const SumOverProcesses& sum) {
  const Spread spread(points, sum);
  if (V.cols() == 0 || !(spread.allowed > 0)) return {};
  const DenseMatrix c = tangential_motions(generators, V, points, spread.allowed, decided, sum);
  make_tangential(d, generators, c, points, to_free_motions);
  return slips_of(c);
}

}  // namespace frictioncg
