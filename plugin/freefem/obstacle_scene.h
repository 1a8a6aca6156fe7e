#pragma once
#include "freefem.h"

#include "space.h"

namespace frictioncg {

/// One body and an obstacle, at the contact points.
template <class FESpaceType>
std::shared_ptr<Scene> obstacle_scene(const Placement<FESpaceType>& Vh,
                                      std::vector<BoundaryNode> points) {
  auto scene = std::make_shared<Scene>();
  scene->d = Dimension<FESpaceType>::d;
  scene->dofs = dofs_of(Vh.space().NbOfDF);
  scene->nodes = std::move(points);
  observe(Vh, *scene);
  return scene;
}

/// The contact points of the labels, in one process.
template <class FESpaceType>
std::vector<BoundaryNode> obstacle_points(const NamedSpace<FESpaceType>& space,
                                          const std::vector<long>& labels) {
  if (labels.empty()) return {};
  constexpr int d = Dimension<FESpaceType>::d;
  Boundary boundary = boundary_of(space, labels), begun;
  if (space.Vh.begun()) {
    begun =
        boundary_of<FESpaceType>({*space.Vh.begun(), space.name, space.mesh, space.inside}, labels);
    decide_by(begun, boundary);
  }
  std::vector<BoundaryNode> points = contact_points(d, boundary, boundary.nodes.size());
  if (space.Vh.begun()) remember(contact_points(d, begun, begun.nodes.size()), points);
  follow_motions(space.Vh, points);
  return points;
}
template <class FESpaceType>
std::shared_ptr<Scene> obstacle_scene(const Placement<FESpaceType>& Vh,
                                      const std::vector<long>& labels) {
  return obstacle_scene(Vh, obstacle_points(before_obstacle(Vh), labels));
}

}  // namespace frictioncg
