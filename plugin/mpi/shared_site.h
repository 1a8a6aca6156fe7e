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
  const auto of_owners = [&](const Displacement& u) {
    return u ? std::make_shared<const Vector>(domain.of_owners(*u)) : u;
  };
  return {of_owners(stage.at), of_owners(stage.begun)};  // in this order
}

/// Adds the contact points of own nodes on an obstacle. surface: with the labels that are here;
/// begun: the same where the increment began.   Collective.
inline void add_own_points(const Domain& domain, Boundary surface, Boundary begun, Index bodies,
                           Scene& scene) {
  const bool has_begun = scene.spaces.front()->begun() != nullptr;
  const std::size_t own = surface.nodes.size();
  add_facets_of_others(domain, scene.d, surface);
  if (has_begun) add_facets_of_others(domain, scene.d, begun);
  domain.agree([&] {
    for (const BoundaryNode& n :
         contact_points(scene.d, std::move(surface), has_begun ? &begun : nullptr, own))
      if (domain.owns(n.point.dof[0])) scene.nodes.push_back(n);
  });
  if (domain.largest(any_curved(scene.nodes)) > 0)
    follow_motions(scene.d, body_of_points(scene, scene.places()), bodies, has_begun, scene.nodes,
                   domain);
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
  const std::vector<long> labels = labels_here(domain, *spaces.front(), opening.labels),
                          masters = labels_here(domain, *spaces.back(), opening.masters);
  const Stage stage = with_ghosts(given, dofs, domain);
  std::shared_ptr<Scene> scene;
  std::vector<NodePlace> places;
  Boundary surface, begun;
  domain.agree([&] {
    if (spaces.size() == 1 && opening.labels == opening.masters)
      throw IllegalInput("slave and master have the same labels " + in_brackets(opening.labels) +
                         ": what touches itself is of one process; with domain= name two labels");
    scene = scene_on(at(stage, spaces), {});
    const Space& first = *scene->spaces.front();
    if (site.two_bodies()) {
      scene->pairing.emplace(interface_of(
          scene->spaces,
          {labels, masters, mortar::label_pairs(opening.labels, opening.masters, false)}));
    } else {
      surface = first.boundary(labels);
      if (first.begun()) begun = first.begun()->boundary(labels);
    }
    places = scene->places();
  });
  refuse_other_domain(domain, places);
  const Index bodies = name_bodies(domain, std::move(places), *scene);
  if (!site.two_bodies())
    add_own_points(domain, std::move(surface), std::move(begun), bodies, *scene);
  return scene;
}

}  // namespace frictioncg
