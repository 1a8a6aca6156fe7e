#pragma once
// A sparse scene in local frames, by blocks of mesh nodes, with its hierarchy.
#include "../sparse_scene.h"
#include "core/multigrid/hierarchy.h"

namespace frictioncg::test {

struct SceneInBlocks {
  Posed posed;
  SystemPtr system;
  Eigen::MatrixXd modes;
  NodeBlocks blocks;
  std::unique_ptr<Hierarchy> hierarchy;

  explicit SceneInBlocks(const SparseOptions& options, const HierarchyOptions& how = {})
      : SceneInBlocks(sparse_block(options), how) {}
  explicit SceneInBlocks(const SparseScene& scene, const HierarchyOptions& how = {})
      : posed(scene.system(scene.node_of_dof)),
        system(posed.problem().system),
        modes(system->rigid_modes()),
        blocks(make_node_blocks(system->entries(), system->mesh_node, modes, scene.d,
                                system->interior())),
        hierarchy(make_hierarchy(system->entries(), blocks, modes, how)) {}
};

}  // namespace frictioncg::test
