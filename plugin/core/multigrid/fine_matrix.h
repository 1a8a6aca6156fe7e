#pragma once
#include "multigrid/block_matrix.h"
#include "multigrid/node_blocks.h"

namespace frictioncg {

/// factor A by blocks of mesh nodes, in single precision; empty slots have empty rows.
template <int D>
SymmetricBlocks<D> make_fine_matrix(const Matrix& A, const NodeBlocks& blocks, Real factor);

}  // namespace frictioncg
