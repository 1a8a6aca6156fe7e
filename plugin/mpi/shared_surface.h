#pragma once
#include "../freefem/freefem.h"

#include <map>
#include <set>
#include <unordered_map>

#include "../core/assembly/mortar/topology.h"
#include "../freefem/scene.h"
#include "domain.h"

namespace frictioncg {

// The normals of a process's own nodes are those of one process: they need more of the contact
// boundary than the facets around, and sums over all processes of one body.

/// A number for each dof that all processes call alike; -1 where none owns it.   Collective.
inline Vector global_numbers(const Domain& domain) {
  const Vector counts = domain.gathered(Vector::Constant(1, Real(domain.dofs())));
  Vector number = Vector::Constant(domain.dofs(), -1);
  const Real first = counts.head(domain.rank()).sum();
  for (Index i = 0; i < domain.dofs(); ++i)
    if (domain.owns(i)) number[i] = first + i;
  domain.update(number);
  return number;
}

/// Facets of all processes as they are sent: label, normal, and number and place of each vertex.
class SentFacets {
 public:
  using Key = std::array<Real, 3>;  ///< sorted numbers of the vertices

  /// Each facet from the owner of its vertex with the lowest number.   Collective.
  SentFacets(const Domain& domain, int d, const Boundary& boundary, const Vector& number) : d_(d) {
    std::vector<Real> own;
    for (const BoundaryFacet& f : boundary.facets) {
      Index first = -1;
      for (int v = 0; v < d; ++v) {
        const Index dof = boundary.nodes[f.node[v]].dof[0];
        if (first < 0 || number[dof] < number[first]) first = dof;
      }
      if (!domain.owns(first)) continue;
      own.insert(own.end(), {Real(f.label), f.normal.x, f.normal.y, f.normal.z});
      for (int v = 0; v < d; ++v) {
        const SharedNode& n = boundary.nodes[f.node[v]];
        own.insert(own.end(), {number[n.dof[0]], n.x.x, n.x.y, n.x.z});
      }
    }
    all_ = domain.gathered(Eigen::Map<const Vector>(own.data(), Index(own.size())));
    for (Index f = 0; f < count(); ++f)
      for (int v = 0; v < d; ++v) around_[vertex(f, v)].push_back(f);
  }
  Index count() const { return static_cast<Index>(all_.size()) / (4 * (d_ + 1)); }
  long label(Index f) const { return static_cast<long>(at(f, 0)[0]); }
  Fem2D::R3 normal(Index f) const { return place(at(f, 0)); }
  Real vertex(Index f, int v) const { return at(f, v + 1)[0]; }
  Fem2D::R3 x(Index f, int v) const { return place(at(f, v + 1)); }
  Key key(Index f) const {
    Key k{{-1, -1, -1}};
    for (int v = 0; v < d_; ++v) k[v] = vertex(f, v);
    std::sort(k.begin(), k.end());
    return k;
  }
  /// Those within so many facets of the vertices, in ascending order.
  std::set<Index> within(int rings, std::set<Real> vertices) const {
    std::set<Index> found;
    for (std::set<Real> next; rings > 0; --rings, vertices = std::move(next), next.clear())
      for (Real i : vertices) {
        const auto facets = around_.find(i);
        if (facets == around_.end()) continue;
        for (Index f : facets->second)
          if (found.insert(f).second)
            for (int v = 0; v < d_; ++v) next.insert(vertex(f, v));
      }
    return found;
  }

 private:
  const Real* at(Index f, int part) const { return all_.data() + 4 * ((d_ + 1) * f + part); }
  static Fem2D::R3 place(const Real* four) { return Fem2D::R3(four[1], four[2], four[3]); }

  const int d_;
  Vector all_;
  std::unordered_map<Real, std::vector<Index>> around_;
};

/// Adds the facets of other processes, and their vertices, that the normals of own nodes depend on:
/// a side's curvature is that two vertices away, which two rings of facets around it tell.
/// Collective.
inline void add_facets_of_others(const Domain& domain, int d, Boundary& boundary) {
  constexpr int rings = 4;
  const Vector number = global_numbers(domain);
  const SentFacets sent(domain, d, boundary, number);
  std::map<Real, std::size_t> node_of;
  std::set<Real> own;
  for (std::size_t i = 0; i < boundary.nodes.size(); ++i) {
    const Index dof = boundary.nodes[i].dof[0];
    node_of[number[dof]] = i;
    if (domain.owns(dof)) own.insert(number[dof]);
  }
  std::set<SentFacets::Key> here;
  for (const BoundaryFacet& f : boundary.facets) {
    SentFacets::Key key{{-1, -1, -1}};
    for (int v = 0; v < d; ++v) key[v] = number[boundary.nodes[f.node[v]].dof[0]];
    std::sort(key.begin(), key.end());
    here.insert(key);
  }
  for (Index f : sent.within(rings, own)) {
    if (here.count(sent.key(f)) > 0) continue;
    BoundaryFacet facet{sent.label(f), sent.normal(f), {}};
    for (int v = 0; v < d; ++v) {
      const auto [entry, is_new] = node_of.emplace(sent.vertex(f, v), boundary.nodes.size());
      if (is_new) boundary.nodes.push_back({{{-1, -1, -1}}, sent.x(f, v), {}});
      AdjacentFacet at;
      at.label = facet.label;
      at.normal = facet.normal;
      at.place = boundary.facets.size();
      boundary.nodes[entry->second].facets.push_back(at);
      facet.node.push_back(entry->second);
    }
    boundary.facets.push_back(std::move(facet));
  }
}

/// The bodies of all processes, from the parts of each that hang together: those with a node in
/// common are one body.
struct SharedBodies {
  std::vector<Index> of_part;  ///< of each part here
  Index count = 0;

  /// Collective.
  SharedBodies(const Domain& domain, const std::vector<NodePlace>& places) {
    std::vector<Index> part(domain.dofs(), -1);
    Index parts = 0;
    for (const NodePlace& n : places) {
      parts = std::max(parts, n.body + 1);
      part[n.dof[0]] = n.body;
    }
    const Vector counts = domain.gathered(Vector::Constant(1, Real(parts)));
    const Index first = static_cast<Index>(counts.head(domain.rank()).sum());
    std::set<std::pair<Index, Index>> same;
    domain.update(
        1, [&](Index dof, Real* out) { *out = part[dof] < 0 ? -1 : first + part[dof]; },
        [&](Index dof, const Real* theirs) {
          if (*theirs >= 0 && part[dof] >= 0)
            same.emplace(first + part[dof], static_cast<Index>(*theirs));
        });
    Vector own(2 * static_cast<Index>(same.size()));
    Index k = 0;
    for (const auto& [a, b] : same) own[k++] = a, own[k++] = b;
    const Vector pairs = domain.gathered(own);
    mortar::Groups groups(static_cast<Index>(counts.sum()));
    for (Index p = 0; p + 1 < pairs.size(); p += 2)
      groups.join(static_cast<Index>(pairs[p]), static_cast<Index>(pairs[p + 1]));
    std::map<Index, Index> body;
    for (Index p = 0; p < static_cast<Index>(counts.sum()); ++p)
      body.try_emplace(groups.of(p), static_cast<Index>(body.size()));
    for (Index p = 0; p < parts; ++p) of_part.push_back(body.at(groups.of(first + p)));
    count = static_cast<Index>(body.size());
  }
};

/// As in one process, over the own points of all.   Collective.
inline void follow_motions_of_all(const Domain& domain, const std::vector<NodePlace>& places,
                                  Scene& scene) {
  if (domain.largest(any_curved(scene.nodes)) == 0) return;
  const SharedBodies bodies(domain, places);
  std::vector<Index> part(domain.dofs(), 0), body;
  for (const NodePlace& n : places) part[n.dof[0]] = n.body;
  for (const BoundaryNode& p : scene.nodes) body.push_back(bodies.of_part[part[p.point.dof[0]]]);
  follow_motions(scene.d, body, bodies.count, scene.nodes,
                 [&](Real* values, Index count) { domain.sum(values, count); });
}

}  // namespace frictioncg
