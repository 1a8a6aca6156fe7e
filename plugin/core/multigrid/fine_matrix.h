#pragma once
#include "multigrid/exact_matrix.h"
#include "multigrid/node_blocks.h"

namespace frictioncg {

/// factor A by blocks of mesh nodes, in single precision, and A at the same places; empty slots
/// have empty rows.
template <int D>
SymmetricBlocks<D> make_fine_matrix(const Matrix& A, const NodeBlocks& blocks, Real factor,
                                    ExactMatrix<D>& exact);

}  // namespace frictioncg
