#pragma once
#include "freefem.h"

#include "obstacle_scene.h"

namespace frictioncg {

/// The labels of two bodies; those that this process's part of the meshes has, and all pairs.
struct PairLabels {
  PairLabels(std::vector<long> slave_, std::vector<long> master_)
      : slave(std::move(slave_)),
        master(std::move(master_)),
        pairs(mortar::label_pairs(slave, master)) {}

  std::vector<long> slave, master;
  std::vector<mortar::LabelPair> pairs;
  bool of_part = false;  ///< of meshes that other processes have parts of
};

/// A facet has one partner: a body, or the obstacle.
inline void refuse_second_role(const std::vector<long>& obstacle, const std::vector<long>& side,
                               const char* role) {
  for (long label : obstacle)
    if (std::count(side.begin(), side.end(), label))
      throw IllegalInput("label " + std::to_string(label) + " is " + role +
                         " and on the obstacle; a boundary touches one of them: give its parts "
                         "labels of their own");
}

/// Two bodies in one space: two parts of a mesh, or the faces of a crack; obstacle: labels beside
/// them.
template <class FESpaceType>
std::shared_ptr<Scene> pair_scene(const Placement<FESpaceType>& Vh, const PairLabels& labels,
                                  const std::vector<long>& obstacle = {}) {
  auto scene = std::make_shared<Scene>();
  scene->d = Dimension<FESpaceType>::d;
  scene->dofs = dofs_of(Vh.space().NbOfDF);
  refuse_second_role(obstacle, labels.slave, "slave");
  refuse_second_role(obstacle, labels.master, "master");
  scene->nodes = obstacle_points(before_obstacle(Vh), obstacle);
  const NamedSpace<FESpaceType> space{Vh, "Vh", "the mesh", pair_inside};
  InterfaceBuilder faces(labels.pairs, labels.of_part);
  faces.add_slave(BoundaryNodes<FESpaceType>(space, labels.slave));
  faces.add_master(BoundaryNodes<FESpaceType>(space, labels.master), 0);
  scene->pairing.emplace(faces.take());
  observe(Vh, *scene);
  return scene;
}

/// Which labels of an obstacle are on which of two meshes.
template <class FESpaceType>
std::array<std::vector<long>, 2> by_mesh(const FESpaceType& V1, const FESpaceType& V2,
                                         const std::vector<long>& obstacle) {
  std::array<std::vector<long>, 2> labels;
  if (obstacle.empty()) return labels;
  const std::set<long> first = labels_of_boundary(V1), second = labels_of_boundary(V2);
  for (long label : obstacle) {
    const bool in_first = first.count(label) > 0, in_second = second.count(label) > 0;
    if (in_first == in_second)
      throw IllegalInput(
          "obstacle has the label " + std::to_string(label) +
          (in_first ? ", which is on the mesh of V1 and on that of V2; give one of them another "
                      "label, by change(Th, label=...)"
                    : ", which is neither on the mesh of V1 nor on that of V2"));
    labels[in_first ? 0 : 1].push_back(label);
  }
  return labels;
}

/// The contact points of an obstacle beside two bodies in spaces of their own.
template <class FESpaceType>
std::vector<BoundaryNode> obstacle_points(const Placement<FESpaceType>& V1,
                                          const Placement<FESpaceType>& V2,
                                          const PairLabels& labels,
                                          const std::vector<long>& obstacle) {
  const auto [first, second] = by_mesh(V1.space(), V2.space(), obstacle);
  refuse_second_role(first, labels.slave, "slave");
  refuse_second_role(second, labels.master, "master");
  std::vector<BoundaryNode> points =
      obstacle_points(before_obstacle(V1, "V1", "the mesh of V1"), first);
  for (BoundaryNode& p : obstacle_points(before_obstacle(V2, "V2", "the mesh of V2"), second)) {
    p.point.dof = shifted(V1.space().NbOfDF, Dimension<FESpaceType>::d, p.point.dof);
    p.space = 1;
    if (p.begun) p.begun->space = 1;
    points.push_back(std::move(p));
  }
  return points;
}

/// Two bodies in spaces of their own: the dofs of V2 follow those of V1.
template <class FESpaceType>
std::shared_ptr<Scene> pair_scene(const Placement<FESpaceType>& V1,
                                  const Placement<FESpaceType>& V2, const PairLabels& labels,
                                  const std::vector<long>& obstacle = {}) {
  auto scene = std::make_shared<Scene>();
  scene->d = Dimension<FESpaceType>::d;
  const Index offset = V1.space().NbOfDF;
  scene->dofs = dofs_of(offset, V2.space().NbOfDF);
  scene->nodes = obstacle_points(V1, V2, labels, obstacle);
  InterfaceBuilder faces(labels.pairs, labels.of_part);
  faces.add_slave(
      BoundaryNodes<FESpaceType>({V1, "V1", "the mesh of V1", pair_inside}, labels.slave));
  faces.add_master(
      BoundaryNodes<FESpaceType>({V2, "V2", "the mesh of V2", pair_inside}, labels.master), offset);
  scene->pairing.emplace(faces.take());
  observe(V1, *scene);
  for (Index node : mesh_nodes(V2.space())) scene->mesh_node.push_back(V1.space().NbOfNodes + node);
  scene->go_to = [V1, V2](MeshPoint* mp, const BoundaryNode& node) {
    go_to(mp, node.space == 0 ? V1 : V2, node);
  };
  scene->places = once([of_first = scene->places, V2, offset, d = scene->d] {
    std::vector<NodePlace> places = of_first();
    Index bodies = 0;
    for (const NodePlace& n : places) bodies = std::max(bodies, n.body + 1);
    for (NodePlace n : node_places(V2)) {
      n.body += bodies;
      n.dof = shifted(offset, d, n.dof);
      places.push_back(n);
    }
    return places;
  });
  scene->labelled = once([of_first = scene->labelled, V2, offset, d = scene->d] {
    std::vector<LabelledNode> all = of_first();
    for (LabelledNode n : labelled_nodes(V2)) {
      n.space = 1;
      n.dof = shifted(offset, d, n.dof);
      all.push_back(n);
    }
    return all;
  });
  return scene;
}

}  // namespace frictioncg
