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

/// The rows of T that have one entry: u_i = factor w[image], image beyond the local dofs where
/// Dirichlet conditions hold u_i.
struct Images {
  explicit Images(const Basis& basis);
  /// n: the image of a free dof with factor 1, as nearly all are; negative otherwise.
  std::vector<Index> plain;
  struct Image {
    Index image = -1;  ///< -1: the row has several entries
    Real factor = 1;
    bool single() const { return image >= 0; }
  };
  std::vector<Image> all;  ///< n
};

/// A change u = T v among the dofs of the script, v = W u, both n x n, with rows of the identity at
/// Dirichlet dofs: v of a contact node is its displacement relative to the other body.
struct Coupling {
  Matrix T, W;
};

/// A basis of v as one of u.
Basis composed(const Coupling& coupling, const Basis& of_v);

}  // namespace frictioncg
