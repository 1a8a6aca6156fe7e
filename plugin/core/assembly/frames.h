#pragma once
#include <Eigen/Geometry>

#include "assembly/basis.h"
#include "assembly/dirichlet.h"

namespace frictioncg {

/// A further obstacle of a contact node: what Dirichlet conditions leave free of the node's own
/// normal is factor times what they leave of this one's.
struct Rival {
  Index point = 0;  ///< contact point
  Real factor = 1;  ///< > 0
};

/// A contact node as the laws see it: one normal, and the tangents where it has friction.
struct ContactNode {
  Index point = 0;      ///< contact point
  bool shared = false;  ///< its mesh node has several normals: it slides without friction
  std::vector<Rival> rivals = {};  ///< the nearest of all its obstacles counts
};

/// What is wrong with the obstacles at a node.
constexpr const char* dependent_normals =
    " have linearly dependent normals on what is free to move there; give one normal for all of "
    "them, or labels that leave one of these faces out; facets of one curved face meet by less "
    "than 30 degrees";
constexpr const char* different_gaps =
    " are at different gaps along the one direction that is free to move there, and bilateral "
    "contact can follow one alone; give one gap, or labels that leave one of these faces out";

/// The obstacles at one mesh node ask for what its free directions cannot give.
struct ConflictingObstacles : IllegalInput {
  ConflictingObstacles(Index point_, const std::string& where, const char* why_)
      : IllegalInput("the obstacles at " + where + why_), point(point_), why(why_) {}
  Index point;      ///< contact point: the last of the mesh node
  const char* why;  ///< dependent_normals, different_gaps, or of obstacles that move
};

/// Local frames at the contact points.
///
/// One normal: w_N = n.u, and tangents, orthonormal among the free components and orthogonal to
/// what Dirichlet conditions leave free of the normal: the body gives way along its projection, and
/// r_N is the force along the whole of n. A point whose normal is held is no contact node.
/// Orthotropic friction turns the tangents to its principal directions and scales them.
///
/// Several normals at one node (a corner): w_j = n_j.u for each, and the rest of an orthonormal
/// basis of what is orthogonal to them all: rows of W are the normals, columns of T their dual
/// basis. Where Dirichlet conditions leave two of them parallel (the tip of a groove held along it)
/// they are rivals for one direction. Throws ConflictingObstacles where they depend on each
/// other otherwise.
struct Frames {
  std::shared_ptr<const Basis> basis;
  std::vector<ContactNode> nodes;
};
/// n dofs in all.
Frames frames_at(int dimension, Index n, const std::vector<ContactPoint>& points,
                 const Dirichlet& dirichlet);

}  // namespace frictioncg
