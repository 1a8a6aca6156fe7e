#pragma once
#include "assembly/mortar/moments.h"
#include "assembly/mortar/weight_slopes.h"

namespace frictioncg::mortar {

/// d(G'y)/dX, where the forces y keep their parts along normals and tangents: both turn with the
/// slave (turns_of_normal),
///
///   dy_i = (n_i x dn_i) x y_i
///
/// and dg_i/dX of the nodes that y loads. Left out are the rims of what is covered, normals that
/// the master gives or the caller, and the shares of crossings: they are taken to stand still.
///
/// y of Options::force are those of the mortar, whose rows are given; none where it is empty.
GeometricStiffness geometric_stiffness(const Mortar& mortar, const Arrangement& of,
                                       const std::map<Index, SlopedRow>& rows,
                                       const Crossings& crossings, const Options& options);

/// To first order, where U grows by v, and by it the places of nodes by x: those of P2 edges stay
/// between their ends.
struct Change {
  std::vector<Vec3> force;  ///< of G'y, at each node
  Vector gap;  ///< of g + n.G U, the bound on n.G u at each contact node; 0 where y loads none
};
Change change(const Mortar& mortar, const std::vector<Vec3>& v, const std::vector<Vec3>& x);

}  // namespace frictioncg::mortar
