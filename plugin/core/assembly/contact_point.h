#pragma once
#include <array>

#include "types.h"

namespace frictioncg {

/// A point of the boundary that may touch, with one normal. d = 2 or 3 components are used. A node
/// in a corner has several points: the same dofs, linearly independent normals.
struct ContactPoint {
  std::array<Index, 3> dof{{-1, -1, -1}};  ///< of each component of the displacement
  std::array<Real, 3> normal{{0, 0, 0}};   ///< unit, outward from the body
  bool friction = false;                   ///< has a tangential law
  /// Orthotropic friction in 3D: |(F_1, F_2/across)| <= g, F_1 along this tangent (unit), F_2
  /// across.
  std::array<Real, 3> direction{{0, 0, 0}};
  Real mu_ratio = 1;  ///< coefficient across over coefficient along, > 0
};

}  // namespace frictioncg
