#pragma once
#include <Eigen/Geometry>

#include "linear_algebra.h"
#include "types.h"

namespace frictioncg {

/// A point of a boundary with its normal.
struct PointNormal {
  Vec3 x, normal;
  Real weight = 0;  ///< share of the boundary, >= 0
  Real turn = 0;    ///< angle between the normal and the facets there; exactly 0: it is left alone
};

/// Mean square of n.w over that of w that facets at such an angle to the normal leave unknown: of
/// (turn^2/4), their sagitta over the radius.
inline Real untold(Real turn) { return std::pow(turn, 4) / 16; }

/// Adds numbers over all processes, in place.
using SumOverProcesses = std::function<void(Real* values, Index count)>;

/// The rigid motions w(x) = e, r x (x - centre)/size along and about the axes: 3, in 3D 6.
class RigidGenerators {
 public:
  using Fields = Eigen::Matrix<Real, 3, Eigen::Dynamic, 0, 3, 6>;

  RigidGenerators(int d, const Vec3& centre, Real size) : d_(d), centre_(centre), size_(size) {}
  Index count() const { return rigid_components(d_); }
  Fields at(const Vec3& x) const;  ///< 3 x count()
  /// Component c about a pivot, as a column of generators: a translation, or a rotation by 1 over
  /// the size.
  Vector about(const Vec3& pivot, Index c) const;

 private:
  int d_;
  Vec3 centre_;
  Real size_;
};

/// Which motions normals leave tangential, as decided once an increment, where that began.
struct Slips {
  Index count = 0;
  bool rotations = false;  ///< in place of screws
  Real told = 0;           ///< mean square of n.w over that of w, up to which they may be any
  operator Index() const { return count; }
};
using DecidedSlips = std::optional<Slips>;  ///< none: it is decided here
Slips slips_of(const DenseMatrix& motions);

/// Of what motions span (`among`, generators x k) the combinations, as columns of generators, that
/// normals leave tangential:   Q c = lambda M c,  lambda <= allowed,  Q = sum m (w'n)(w'n)',  M =
/// sum m w'w, with a mean square of w of 1. In place of screws they are rotations, where those are
/// among them and allowed, too. Of the number decided where fewer points were, those are
/// none that the points of now resist clearly.
DenseMatrix tangential_motions(const RigidGenerators& generators, const DenseMatrix& among,
                               const std::vector<PointNormal>& points, Real allowed,
                               DecidedSlips decided = {}, const SumOverProcesses& sum = {});

/// Where normals are made tangential to motions.
struct Tangential {
  Real moved;  ///< only where a point moves by more than this share of the mean motion
  Real kept;   ///< only where more than this share of the normal is left
};
/// Makes normals that turn tangential to such motions.
void make_tangential(int d, const RigidGenerators& generators, const DenseMatrix& motions,
                     std::vector<PointNormal>& points, Tangential where);

/// Normals of one body that some rigid motions leave tangential as far as the mesh can tell (a
/// surface of revolution, a cylinder, a screw) are made to leave them so exactly: the mesh knows
/// its vertices only up to what made them, and a wedge, however small, against a motion that
/// nothing else resists holds any load.
///
/// Motions w(x) = c + r x (x - x0)/L with   rms n.w <= e rms |w|,  e = rms (turn^2/4): the sagitta
/// of the facets over the radius.
Slips follow_slippable_motions(int d, std::vector<PointNormal>& points, DecidedSlips decided = {},
                               const SumOverProcesses& sum = {});

/// Where supports leave free motions V (generators x k) alone, those of them that normals leave
/// tangential as far as the mesh can tell are left so to rounding: the axis that the normals tell
/// by themselves is tilted by their errors, and the supports resist what it adds.
Slips follow_free_motions(int d, const RigidGenerators& generators, const DenseMatrix& V,
                          std::vector<PointNormal>& points, DecidedSlips decided = {},
                          const SumOverProcesses& sum = {});
/// The axis is that of the motions, exactly.
constexpr Tangential to_free_motions{1e-6, 0.5};

}  // namespace frictioncg
