#pragma once
#include <Eigen/Geometry>

#include "assembly/frames.h"

namespace frictioncg {

/// Rigid obstacles that move, each by q = (translation of its pivot, small rotation about it): 3
/// numbers in 2D, 6 in 3D [length, radians]. The laws of a contact node hold in what it moves
/// relative to its obstacle:
///
///   u_s = w + B_s q,   B_s q = q_t + q_r x (x_s - pivot)
///
/// Components are given, or free under a load [force, moment]: an obstacle is one more body, which
/// has no stiffness, and whose dofs follow those of the script, obstacle by obstacle.
struct RigidObstacles {
  std::vector<Index> of_point;  ///< of each contact point: its obstacle; -1: it stands still
  std::vector<Vec3> arm;        ///< of each contact point: from the pivot to it [length]
  std::vector<char> free;       ///< of each component of each obstacle

  Index dofs() const { return static_cast<Index>(free.size()); }  ///< n_q
};

/// A free component that moves no contact node: nothing says what it is.
struct UselessComponent : IllegalInput {
  UselessComponent(Index component_)
      : IllegalInput("a free motion of an obstacle moves no contact node"), component(component_) {}
  Index component;  ///< of all obstacles
};

constexpr const char* moving_rivals =
    " have one direction that is free to move there between them, and one of them moves; give "
    "labels that leave one of these faces out";

/// The basis of (u, q), n + n_q dofs, from that of u before obstacles that stand still. Free
/// components are the last of the interior dofs, in lengths: rotations times the extent of their
/// contact points. Given ones follow the prescribed displacements.
/// Throws UselessComponent, and ConflictingObstacles for several normals along one free direction.
Basis with_obstacles(const Basis& standing, int dimension, const std::vector<ContactPoint>& points,
                     const std::vector<ContactNode>& nodes, const RigidObstacles& obstacles);

/// Rigid motions of bodies (n x k), and those of the obstacles beside them:   (n + n_q) x (k + n_q)
Matrix with_obstacles(const Matrix& modes, Index n_q);

}  // namespace frictioncg
