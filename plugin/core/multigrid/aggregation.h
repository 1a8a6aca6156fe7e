#pragma once
#include "multigrid/block_matrix.h"

namespace frictioncg {

/// The graph of a symmetric block matrix: all neighbours of each row, and where their block is
/// stored. Block (i, j) with j > i is the transposed of what is stored.
struct BlockGraph {
  std::vector<Index> begin{0};   ///< rows + 1
  std::vector<Index> neighbour;  ///< sorted in each row, without the row itself
  std::vector<Index> stored;     ///< index of the block
  Index rows() const { return static_cast<Index>(begin.size()) - 1; }
};

template <int B>
BlockGraph make_graph(const SymmetricBlocks<B>& A);

/// |A_ij| / sqrt(|A_ii| |A_jj|) in the Frobenius norm, for each stored block.
template <int B>
std::vector<float> coupling_strength(const SymmetricBlocks<B>& A);

/// A partition of the rows into connected aggregates.
struct Aggregates {
  Index count = 0;
  std::vector<Index> of;  ///< rows
};

struct Coarsening {
  float threshold;  ///< couplings weaker than this share of the strongest of both rows do not count
  float ratio;      ///< least number of rows an aggregate: below it the threshold is halved
};

/// Greedy: a row whose neighbours are all left makes an aggregate with them; the rows that remain
/// join the neighbour they are coupled to most, or make an aggregate of what is left around them.
Aggregates aggregate(const BlockGraph& graph, const std::vector<float>& strength,
                     Coarsening coarsening);

}  // namespace frictioncg
