#pragma once
#include <Eigen/Core>

#include "types.h"

namespace frictioncg {

/// The rigid motions of a body in the dofs of a system: n x 3 in 2D (two translations, a rotation),
/// n x 6 in 3D. They span the kernel of A where nothing holds the body.
///
/// position, direction (n x d): where each dof is, and the displacement of the body there per unit
/// of the dof. For a dof of a local frame that is a column of the frame; in orthotropic friction
/// divided by its length. Rotations are about the mean position, scaled by the size of the body, so
/// that all modes are of one size.
Eigen::MatrixXd rigid_modes(const Eigen::MatrixXd& position, const Eigen::MatrixXd& direction);

}  // namespace frictioncg
