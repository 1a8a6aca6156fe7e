#pragma once
#include "../freefem/freefem.h"

#include "../freefem/operators.h"
#include "opening.h"
#include "shared_call.h"
#include "shared_surface.h"

namespace frictioncg {

/// Those of the labels that are on this part's boundary; each is on that of some.   Collective.
inline std::vector<long> labels_here(const Domain& domain, const Space& Vh,
                                     const std::vector<long>& labels) {
  const std::set<long> boundary = Vh.labels();
  std::vector<long> present;
  for (long label : labels) {
    if (label == cut)
      refuse("label ", label,
             " is what macro_ddm.idp gives to the cuts between processes, which "
             "touch nothing; name labels of the whole mesh's boundary");
    const bool here = boundary.count(label) > 0;
    if (here) present.push_back(label);
    if (domain.largest(here) == 0)
      refuse("label ", label, " is not on the boundary of any part of ", Vh.mesh_in_words());
  }
  return present;
}

inline void check_size(const Domain& domain, const DofCount& dofs) {
  if (dofs.count == domain.dofs() && (domain.first() == 0 || domain.first() == dofs.first)) return;
  refuse(dofs.in_words(), " but the domain ", domain.dofs(),
         (dofs.first == 0
              ? "; make it by createMat(Th, C, Pk) with the mesh and the elements of Vh"
              : "; give domain=[C1, C2], made by createMat(Th1, C1, Pk) and createMat(Th2, C2, Pk) "
                "with the meshes of V1 and V2"));
}

/// As owners of nodes have it.   Collective.
inline Stage with_ghosts(const Stage& stage, const DofCount& dofs, const Domain& domain) {
  domain.agree([&] { check_stage(stage, dofs); });
  const auto of_owners = [&](const Displacement& u) -> Displacement {
    if (!u) return u;
    Vector updated = *u;
    domain.update(updated);
    return std::make_shared<const Vector>(std::move(updated));
  };
  const Displacement at = of_owners(stage.at);
  return {at, of_owners(stage.begun)};
}

/// One body, by the labels that are here.
inline std::shared_ptr<Scene> obstacle_part(const SpacePtr& Vh, const std::vector<long>& labels,
                                            const Domain& domain, const Stage& stage) {
  SpacePtr place;
  Boundary surface, begun;
  std::vector<NodePlace> places;
  domain.agree([&] {
    place = Vh->at(stage);
    surface = place->boundary(labels);
    if (place->begun()) begun = place->begun()->boundary(labels);
    place->add_places(places);
  });
  refuse_other_domain(domain, places);
  const std::size_t own = surface.nodes.size();
  add_facets_of_others(domain, place->d, surface);
  if (place->begun()) add_facets_of_others(domain, place->d, begun);
  std::shared_ptr<Scene> scene;
  domain.agree([&] {
    std::vector<BoundaryNode> points =
        contact_points(place->d, std::move(surface), place->begun() ? &begun : nullptr, own);
    const auto is_ghost = [&](const BoundaryNode& n) { return !domain.owns(n.point.dof[0]); };
    points.erase(std::remove_if(points.begin(), points.end(), is_ghost), points.end());
    scene = scene_on({place}, std::move(points));
  });
  const Index bodies = name_bodies(domain, std::move(places), *scene);
  if (domain.largest(any_curved(scene->nodes)) > 0)
    follow_motions(scene->d, body_of_points(*scene, scene->places()), bodies,
                   place->begun() != nullptr, scene->nodes, domain);
  return scene;
}

inline std::shared_ptr<Scene> pair_part(const Spaces& on_mesh, const std::vector<long>& slave,
                                        const std::vector<long>& master, const Opening& opening,
                                        const Domain& domain, const Stage& stage) {
  std::shared_ptr<Scene> scene;
  std::vector<NodePlace> places;
  domain.agree([&] {
    if (on_mesh.size() == 1 && opening.labels == opening.masters)
      throw IllegalInput("slave and master have the same labels " + in_brackets(opening.labels) +
                         ": what touches itself is of one process; with domain= name two labels");
    PairLabels labels{opening.labels, opening.masters};
    labels.slave = slave;
    labels.master = master;
    const Spaces spaces = at(stage, on_mesh);
    scene = scene_on(spaces, {});
    scene->pairing.emplace(interface_of(spaces, labels));
    places = scene->places();
  });
  refuse_other_domain(domain, places);
  name_bodies(domain, std::move(places), *scene);
  return scene;
}

/// The part of this process, where the stage says, of whose labels it may have none; those of the
/// opening are the same on all.   Collective.
inline std::shared_ptr<Scene> part_of(const Site& site, Stack stack, const Opening& opening,
                                      const Domain& domain, const Stage& given) {
  Spaces spaces;
  DofCount dofs;
  domain.agree([&] {
    spaces = site.spaces(stack);
    dofs = dofs_of(spaces);
    check_size(domain, dofs);
  });
  const std::vector<long> labels = labels_here(domain, *spaces.front(), opening.labels);
  if (!site.two_bodies())
    return obstacle_part(spaces.front(), labels, domain, with_ghosts(given, dofs, domain));
  const std::vector<long> masters = labels_here(domain, *spaces.back(), opening.masters);
  return pair_part(spaces, labels, masters, opening, domain, with_ghosts(given, dofs, domain));
}

}  // namespace frictioncg
