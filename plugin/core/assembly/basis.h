#pragma once
#include "types.h"

namespace frictioncg {

/// The change of basis u = T [w; u_D] in which the laws of contact hold dof by dof in w, with its
/// inverse w = W u. u: n dofs of the script, then those of obstacles that move; w: n_w local dofs;
/// u_D: prescribed displacements.
///
/// By virtual work loads go T'b, and forces lambda on the contact dofs come back as W'lambda: on
/// the obstacle's normal whole, what Dirichlet conditions hold of it included, the reactions of the
/// supports left out. Frames of contact nodes fill it, on top of the relative displacements of a
/// mortar where two bodies touch.
struct Basis {
  Matrix T;                   ///< n x (n_w + n_D)
  Matrix W;                   ///< n_w x n
  std::vector<Index> first;   ///< m + 1, as in System
  std::vector<Index> origin;  ///< n_w: the dof of the script that a local dof stands for
  bool rotated = false;       ///< some row of T has more than one entry

  Index local_dofs() const { return static_cast<Index>(origin.size()); }
};

/// A change u = T v among the dofs of the script, v = W u, both n x n, with rows of the identity at
/// Dirichlet dofs: v of a contact node is its displacement relative to the other body.
struct Coupling {
  Matrix T, W;
};

}  // namespace frictioncg
