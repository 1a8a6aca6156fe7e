#pragma once
#include "assembly/triplets.h"

namespace frictioncg {

/// The component that is the radius, where A looks assembled from axisymmetric forms in 2D, or -1.
/// node: of each dof, with its components one after the other.
///
/// A translation along the radius strains rings, u_r/r, at every node; along the axis nothing is
/// strained, and in plane forms neither way. What both ways meet alike (mass) is no sign of it, and
/// springs and supports, at a few nodes, are none either. A bed of springs along one component is
/// told from rings by these: stretched, they press along the axis, too, where nu is not 0, which
/// the ends of the body feel. With nu = 0, or tgv = -1 or -2 at both ends, nothing tells them
/// apart.
int radial_component(const Triplets& A, const std::vector<Index>& node);

}  // namespace frictioncg
