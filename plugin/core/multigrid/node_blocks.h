#pragma once
#include "multigrid/parts.h"

namespace frictioncg {

/// The dofs of a system gathered by mesh nodes: block b has `size` slots, of which a node with
/// fewer dofs (Dirichlet conditions took the others) leaves some empty.
struct NodeBlocks {
  int size = 3;                ///< slots of a block: the dimension, 2 or 3
  Index blocks = 0;            ///< mesh nodes with dofs
  Parts parts;                 ///< of the blocks
  std::vector<Index> contact;  ///< blocks of nodes with contact dofs, ascending
  std::vector<Index> slot;     ///< n, of each dof: size * block + place in the block
  std::vector<Index> dof;      ///< size * blocks, of each slot; -1 where the slot is empty

  Eigen::MatrixXd place;  ///< blocks x size, where they lie

  Index slots() const { return size * blocks; }
  Index dofs() const { return static_cast<Index>(slot.size()); }
};

/// mesh_node (n): dofs with one number share a mesh node, `dimension` of them at most. Contact dofs
/// are those from first_contact_dof on. modes: rigid motions, which tell where nodes lie.
NodeBlocks make_node_blocks(const Matrix& A, const std::vector<Index>& mesh_node,
                            const Eigen::MatrixXd& modes, int dimension, Index first_contact_dof);

}  // namespace frictioncg
