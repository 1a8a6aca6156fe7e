#pragma once
#include "assembly/basis.h"
#include "assembly/triplets.h"

namespace frictioncg {

/// A in the local dofs: T = [T_w, T_D], A_local = T_w'A T_w, and K = T_w'A T_D, the forces of
/// prescribed displacements. One pass over the triplets builds the rows; only entries that touch a
/// row of T with several entries take a sparse product, T'(their part of A)T.
/// Throws IllegalInput where nothing is free, or where 32 bits do not index the entries.
void transform(const Triplets& A, const Basis& basis, Matrix& A_local, Matrix& K);

/// Where in A_local each entry of A went, by its number; -1 for a zero.
using Places = std::vector<Index>;

/// The same for a matrix that comes again with other values. A_local has the pattern of the last
/// one; places, of the last one, too, or empty, say where to look first. Where A has an entry
/// outside that pattern, or other dofs are held, A_local gets another one, of all that A stores,
/// its zeros included: those of meshes at rest come and go.
void transform_again(const Triplets& A, const Basis& basis, Places& places, Matrix& A_local,
                     Matrix& K);

/// Throws IllegalInput where A_local, of diagonal D, is not symmetric between whole rows of A;
/// origin: as in Basis.
void check_symmetry(const Triplets& A, const Matrix& A_local, const Vector& D,
                    const std::vector<Index>& origin);

}  // namespace frictioncg
