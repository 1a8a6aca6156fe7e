#include "multigrid/bordered_hierarchy.h"

namespace frictioncg {

namespace {

/// Whether no mesh node has more dofs than the dimension: what is more is no displacement.
bool are_displacements(const System& system) {
  std::vector<int> count;
  for (const Index node : system.mesh_node) {
    if (node >= static_cast<Index>(count.size())) count.resize(node + 1, 0);
    if (++count[node] > system.dimension) return false;
  }
  return !system.mesh_node.empty();
}

}  // namespace

std::unique_ptr<Hierarchy> make_hierarchy(const System& system, const HierarchyOptions& options) {
  if (!system.rigid_modes || !are_displacements(system)) return nullptr;
  Eigen::MatrixXd modes = system.rigid_modes();
  if (modes.rows() != system.dofs() || modes.cols() != rigid_components(system.dimension))
    return nullptr;
  const Index k = static_cast<Index>(system.border.cols()), end = system.interior();
  if (k == 0 || system.dofs() <= options.dense) {
    const NodeBlocks blocks = make_node_blocks(system.mesh_node, system.dimension, end);
    return make_hierarchy(system.entries(), blocks, modes, options);
  }
  std::vector<Index> mesh_node = system.mesh_node;
  mesh_node.erase(mesh_node.begin() + end - k, mesh_node.begin() + end);
  Eigen::MatrixXd of_bodies(system.dofs() - k, modes.cols());
  of_bodies << modes.topRows(end - k), modes.bottomRows(system.contact_dofs());
  const NodeBlocks blocks = make_node_blocks(mesh_node, system.dimension, end - k);
  HierarchyOptions within = options;
  within.multiplies = false;  // by the whole of A alone
  return std::make_unique<BorderedHierarchy>(
      system, make_levels(without_border(system), blocks, of_bodies, within));
}

}  // namespace frictioncg
