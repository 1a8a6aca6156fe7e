#pragma once
#include "model/system.h"

namespace frictioncg {

/// The rigid motions that A leaves free, each of one body, among the candidates of the system: n x
/// k, <Dw,w> = 1. No columns where the system knows no candidates, or has none of n rows.
DenseMatrix floating_motions(const System& system);

/// Whether w moves each body by a combination of the candidates, or the system knows none. A body
/// may be so slender, or so soft in places, that its bending costs next to nothing, and A cannot
/// tell.
bool may_be_rigid(const System& system, const Vector& w);

/// Of motions W (n x k) the combinations that move none of the dofs from `interior` on.
DenseMatrix motions_of_interior(const DenseMatrix& W, Index interior);

/// As many rows of Z as it has columns, from which these are told best, by elimination with pivots;
/// none where its columns are dependent.
std::vector<Index> telling_rows(DenseMatrix Z);

/// Of what Z spans a motion for each of `units`, 1 there and 0 at the others. No columns where
/// there are more or less of them.
DenseMatrix one_for_each(const std::vector<Index>& units, const DenseMatrix& Z);

}  // namespace frictioncg
