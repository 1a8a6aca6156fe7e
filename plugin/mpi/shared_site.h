#pragma once
#include "../freefem/freefem.h"

#include <unordered_map>

#include "../freefem/operators.h"
#include "opening.h"
#include "shared_call.h"

namespace frictioncg {

// The normals of a process's own nodes are those of one process: they need more of the contact
// boundary than the facets around, and sums over all processes of one body.

/// A facet as it is sent, with number and place of each of its 2 or 3 vertices.
struct NumberedFacet {
  using Numbers = std::array<Real, 3>;

  long label;
  Vec3 normal;
  Numbers number{{-1, -1, -1}};
  std::array<Vec3, 3> x = {};
  bool was_sent = false;  ///< by another process

  /// The numbers in ascending order.
  Numbers key() const {
    Numbers sorted = number;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }
};

/// The facets of the contact boundary that a process knows: at first those of its part.
class KnownFacets {
 public:
  using Facets = std::map<NumberedFacet::Numbers, const NumberedFacet*>;
  /// d: vertices of a facet.
  KnownFacets(int d, const Boundary& boundary, const Vector& number) : d_(d) {
    for (const BoundaryFacet& f : boundary.facets) {
      NumberedFacet facet{f.label, f.normal};
      for (int v = 0; v < d; ++v) {
        const SharedNode& n = boundary.nodes[f.node[v]];
        facet.number[v] = number[n.dof[0]];
        facet.x[v] = n.x;
      }
      add(facet);
    }
  }
  void add(const NumberedFacet& f) {
    const auto [place, is_new] = facets_.emplace(f.key(), f);
    for (int v = 0; is_new && v < d_; ++v) around_[f.number[v]].push_back(&place->second);
  }
  /// Those within so many facets of the vertices.
  Facets within(int rings, std::set<Real> vertices) const {
    Facets found;
    for (std::set<Real> next; rings > 0; --rings, vertices = std::move(next), next.clear())
      for (Real i : vertices) {
        const auto facets = around_.find(i);
        if (facets == around_.end()) continue;
        for (const NumberedFacet* f : facets->second)
          if (found.emplace(f->key(), f).second)
            for (int v = 0; v < d_; ++v) next.insert(f->number[v]);
      }
    return found;
  }

 private:
  const int d_;
  std::map<NumberedFacet::Numbers, NumberedFacet> facets_;
  std::unordered_map<Real, std::vector<const NumberedFacet*>> around_;
};

/// Adds those of other processes that lie within so many facets of own vertices, around which all
/// are here. In each round the owner of a vertex sends what it knows around it: one ring more.
/// number: of each dof, over all processes.   Collective.
inline void learn_facets(const Domain& domain, int rings, const Vector& number,
                         KnownFacets& known) {
  const auto unpack = [&](const std::vector<Index>&, const std::vector<NumberedFacet>& received) {
    for (NumberedFacet f : received) {
      f.was_sent = true;
      known.add(f);
    }
  };
  for (int round = 1; round < rings; ++round) {
    const auto pack = [&](const std::vector<Index>& dofs) {
      std::set<Real> vertices;
      for (Index dof : dofs) vertices.insert(number[dof]);
      std::vector<NumberedFacet> sent;
      for (const auto& [key, facet] : known.within(round, vertices)) sent.push_back(*facet);
      return sent;
    };
    domain.tell<NumberedFacet>(pack, unpack);
  }
}

/// Adds the facets of other processes, and their vertices, that the normals of own nodes depend on:
/// a side's curvature is that two vertices away, which two rings of facets around it tell.
/// Collective.
inline void add_facets_of_others(const Domain& domain, int d, Boundary& boundary) {
  constexpr int rings = 4;
  Vector number = Vector::Constant(domain.dofs(), -1);  // which all call alike; -1: none owns it
  const Real first = domain.sum_before(domain.dofs());
  for (Index i = 0; i < domain.dofs(); ++i)
    if (domain.owns(i)) number[i] = first + i;
  domain.update(number);
  std::map<Real, std::size_t> node_of;
  std::set<Real> own;
  for (std::size_t i = 0; i < boundary.nodes.size(); ++i) {
    const Index dof = boundary.nodes[i].dof[0];
    node_of[number[dof]] = i;
    if (domain.owns(dof)) own.insert(number[dof]);
  }
  KnownFacets known(d, boundary, number);
  learn_facets(domain, rings, number, known);
  for (const auto& [key, sent] : known.within(rings, own)) {
    if (!sent->was_sent) continue;
    BoundaryFacet facet{sent->label, sent->normal, {}};
    for (int v = 0; v < d; ++v) {
      const auto [entry, is_new] = node_of.emplace(sent->number[v], boundary.nodes.size());
      if (is_new) boundary.nodes.emplace_back().x = sent->x[v];
      AdjacentFacet at;
      at.label = facet.label;
      at.normal = at.deciding = facet.normal;
      at.place = boundary.facets.size();
      boundary.nodes[entry->second].facets.push_back(at);
      facet.node.push_back(entry->second);
    }
    boundary.facets.push_back(std::move(facet));
  }
}

/// Gives the scene's nodes, wherever it is asked for them, and their bodies as all processes call
/// them. Returns how many bodies there are.   Collective.
inline Index name_bodies(const Domain& domain, std::vector<NodePlace> places, Scene& scene) {
  Bodies parts;
  std::vector<Index> dofs;
  for (const NodePlace& n : places) {
    dofs.push_back(n.dof[0]);
    parts.of.push_back(n.body);
  }
  parts.count = count_bodies(places);
  const Bodies bodies = join_parts(domain, dofs, parts);
  for (std::size_t k = 0; k < places.size(); ++k) places[k].body = bodies.of[k];
  scene.places = [places = std::move(places)] { return places; };
  return bodies.count;
}

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
  if (domain.largest(any_curved(scene.nodes)) == 0) return;
  const NodeDofs at_points = dofs_of(points_of(scene.nodes));
  follow_motions(scene.d, body_of_nodes(at_points, scene.places(), scene.d, scene.ndof()), bodies,
                 has_begun, scene.nodes, domain);
}

/// The part of this process, where the stage says, of whose labels it may have none; those of the
/// opening are the same on all.   Collective.
inline std::shared_ptr<Scene> part_of(const Site& site, Stack stack, const Opening& opening,
                                      const Stage& given) {
  const Domain& domain = *opening.domain;
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
