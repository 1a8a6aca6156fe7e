#pragma once
#include <Eigen/Geometry>

#include <functional>
#include <vector>

#include "types.h"

namespace frictioncg {

/// A point of a boundary with its normal.
struct PointNormal {
  Eigen::Vector3d x, normal;
  Real weight = 0;  ///< share of the boundary, >= 0
  Real turn = 0;    ///< angle between the normal and the facets there; exactly 0: it is left alone
};

/// Adds numbers over all processes, in place.
using SumOverProcesses = std::function<void(Real* values, Index count)>;

/// Normals of one body that some rigid motions leave tangential as far as the mesh can tell (a
/// surface of revolution, a cylinder, a screw) are made to leave them so exactly: the mesh knows
/// its vertices only up to what made them, and a wedge, however small, against a motion that
/// nothing else resists holds any load.
///
/// Motions w(x) = c + r x (x - x0)/L with   rms n.w <= e rms |w|,  e = rms (turn^2/4): the sagitta
/// of the facets over the radius. Returns their number.
int follow_slippable_motions(int d, std::vector<PointNormal>& points,
                             const SumOverProcesses& sum = {});

}  // namespace frictioncg
