#pragma once
#include "assembly/triplets.h"

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

/// Where in A_local each entry of A went, by its number; -1 for a zero.
using Places = std::vector<Index>;

/// A in the local dofs: T = [T_w, T_D], A_local = T_w'A T_w, and K = T_w'A T_D, the forces of
/// prescribed displacements. Only entries that touch a row of T with several entries take a sparse
/// product, T'(their part of A)T.
///
/// For a matrix that comes again with other values A_local has the pattern of the last one, and
/// places, of the last one, too, or empty, say where to look first. Where A has an entry outside
/// that pattern, or other dofs are held, A_local gets another one, of all that A stores, its zeros
/// included: those of meshes at rest come and go.
/// Throws IllegalInput where nothing is free, or where 32 bits do not index the entries.
void transform(const Triplets& A, const Basis& basis, Places& places, Matrix& A_local, Matrix& K);

/// Throws IllegalInput where A_local, of diagonal D, is not symmetric between whole rows of A;
/// origin: as in Basis.
void check_symmetry(const Triplets& A, const Matrix& A_local, const Vector& D,
                    const std::vector<Index>& origin);

}  // namespace frictioncg
