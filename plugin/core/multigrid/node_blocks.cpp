#include "multigrid/node_blocks.h"

#include "multigrid/block_matrix.h"

namespace frictioncg {

NodeBlocks make_node_blocks(const std::vector<Index>& mesh_node, int dimension,
                            Index first_contact_dof) {
  const Index n = static_cast<Index>(mesh_node.size());
  const Index nodes = n == 0 ? 0 : 1 + *std::max_element(mesh_node.begin(), mesh_node.end());
  std::vector<char> touches(nodes, 0);
  for (Index p = first_contact_dof; p < n; ++p) touches[mesh_node[p]] = 1;

  NodeBlocks b;
  b.size = dimension;
  std::vector<Index> block(nodes, -1);
  for (const char contact : {0, 1}) {
    for (Index p = 0; p < n; ++p) {
      const Index node = mesh_node[p];
      if (touches[node] == contact && block[node] < 0) block[node] = b.blocks++;
    }
    if (!contact) b.interior = b.blocks;
  }
  to_block_index(std::size_t(b.blocks) * dimension);
  b.dof.assign(b.slots(), -1);
  b.slot.resize(n);
  for (Index p = 0; p < n; ++p) {
    const Index begin = dimension * block[mesh_node[p]];
    Index place = 0;
    while (place < dimension && b.dof[begin + place] >= 0) ++place;
    if (place == dimension)
      refuse("mesh node ", mesh_node[p], " has more than ", dimension,
             " degrees of freedom; multigrid takes displacements only");
    b.dof[begin + place] = p;
    b.slot[p] = begin + place;
  }
  return b;
}

}  // namespace frictioncg
