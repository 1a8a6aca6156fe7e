#pragma once
// Blocks whose top is moved by Dirichlet data.
#include "scene.h"

namespace frictioncg::test {

/// The block of the options, its top moved by the displacement (in the block's own frame; the load
/// on the top is dropped), the obstacle at the gap below.
inline Scene driven_block(BlockOptions o, const Eigen::Vector3d& displacement, Real gap) {
  o.pressure = o.shear = 0;
  Scene s = block(o);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(o.angle, o.axis.normalized()).toRotationMatrix();
  const Eigen::Vector3d u = R * displacement;
  const Index top = s.n - o.d * static_cast<Index>(std::pow(o.cells + 1, o.d - 1));
  for (std::size_t k = 0; k < s.a.size(); ++k)
    if (s.i[k] == s.j[k] && s.i[k] >= top) {
      s.a[k] = 1e30;
      s.b[s.i[k]] = 1e30 * u[(s.i[k] - top) % o.d];
    }
  s.gap.setConstant(gap);
  return s;
}

/// Brought down by D to an obstacle that it then presses by 0.001 and rubs by 0.0004.
inline Scene brought_from_far(BlockOptions o, Real D) {
  Eigen::Vector3d displacement(0.0004, 0, 0);
  displacement[o.d - 1] = -D - 0.001;
  return driven_block(o, displacement, D);
}

}  // namespace frictioncg::test
