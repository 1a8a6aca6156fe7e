#pragma once
#include "types.h"

namespace frictioncg {

/// The dofs of a system gathered by mesh nodes: block b has `size` slots, of which a node with
/// fewer dofs (Dirichlet conditions took the others) leaves some empty. The blocks of nodes with
/// contact dofs come last.
struct NodeBlocks {
  int size = 3;             ///< slots of a block: the dimension, 2 or 3
  Index blocks = 0;         ///< mesh nodes with dofs
  Index interior = 0;       ///< blocks without contact dofs
  std::vector<Index> slot;  ///< n, of each dof: size * block + place in the block
  std::vector<Index> dof;   ///< size * blocks, of each slot; -1 where the slot is empty

  Index slots() const { return size * blocks; }
  Index dofs() const { return static_cast<Index>(slot.size()); }
};

/// mesh_node (n): dofs with one number share a mesh node. Contact dofs are those from
/// first_contact_dof on. Throws IllegalInput where a node has more dofs than the dimension.
NodeBlocks make_node_blocks(const std::vector<Index>& mesh_node, int dimension,
                            Index first_contact_dof);

}  // namespace frictioncg
