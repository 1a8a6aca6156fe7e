#include "multigrid/node_blocks.h"

#include "multigrid/block_matrix.h"
#include "statics/rigid_motions.h"

namespace frictioncg {

NodeBlocks make_node_blocks(const Matrix& A, const std::vector<Index>& mesh_node,
                            const Eigen::MatrixXd& modes, int dimension, Index first_contact_dof) {
  const Index n = static_cast<Index>(mesh_node.size());
  const Eigen::MatrixXd at = places_of(mesh_node, dimension, modes);
  NodeBlocks b;
  b.size = dimension;
  std::vector<Index> block(at.rows(), -1), node, number;
  for (Index p = 0; p < n; ++p) {
    if (block[mesh_node[p]] >= 0) continue;
    block[mesh_node[p]] = b.blocks++;
    node.push_back(mesh_node[p]);
  }
  Dissection halves(at(node, Eigen::all));
  for (Index p = 0; p < n; ++p)
    for (Matrix::InnerIterator e(A, p); e; ++e)
      halves.couple(block[mesh_node[p]], block[mesh_node[e.col()]]);
  b.parts = halves.numbered(number);
  b.place.resize(b.blocks, dimension);
  for (Index k = 0; k < b.blocks; ++k) {
    block[node[k]] = number[k];
    b.place.row(number[k]) = at.row(node[k]);
  }
  for (Index p = first_contact_dof; p < n; ++p) b.contact.push_back(block[mesh_node[p]]);
  sort_once(b.contact);
  to_block_index(std::size_t(b.blocks) * dimension);
  b.dof.assign(b.slots(), -1);
  b.slot.resize(n);
  for (Index p = 0; p < n; ++p) {
    b.slot[p] = dimension * block[mesh_node[p]];
    while (b.dof[b.slot[p]] >= 0) ++b.slot[p];
    b.dof[b.slot[p]] = p;
  }
  return b;
}

}  // namespace frictioncg
