#pragma once
#include "freefem.h"

#include "../core/assembly/mortar/coupling.h"
#include "../core/assembly/mortar/label_pairs.h"
#include "../core/assembly/mortar/topology.h"
#include "contact_boundary.h"

namespace frictioncg {

/// Which part of the mesh each element belongs to: parts share no vertex.
template <class Mesh>
std::vector<Index> body_of_element(const Mesh& Th, int d) {
  mortar::Groups groups(Th.nv);
  for (int k = 0; k < Th.nt; ++k)
    for (int v = 1; v <= d; ++v) groups.join(Th(k, 0), Th(k, v));
  std::map<Index, Index> number;
  std::vector<Index> body(Th.nt);
  for (int k = 0; k < Th.nt; ++k)
    body[k] =
        number.try_emplace(groups.of(Th(k, 0)), static_cast<Index>(number.size())).first->second;
  return body;
}

/// Slaves and masters as their meshes have them, in one numbering of nodes: those of slaves first.
struct Interface {
  std::vector<mortar::Vec3> X;
  std::vector<mortar::Vec3> moved;  ///< of each node: the displacement that X has already
  bool is_moved = false;
  mortar::NodeDofs dof;
  std::vector<mortar::Pair> pairs;
  std::vector<SharedNode> slave;                     ///< the slaves' nodes
  std::function<std::vector<Index>()> slave_bodies;  ///< the body of each of them
  std::map<Index, Index> body_count;  ///< facet-connected groups of elements at nodes of both sides
};

/// The nodes where they would be by another displacement, by all dofs; empty: none.
inline std::vector<mortar::Vec3> displaced(const Interface& faces, int d, const Vector& u = {}) {
  std::vector<mortar::Vec3> Y;
  for (std::size_t i = 0; i < faces.X.size(); ++i) {
    Y.push_back(faces.X[i] - faces.moved[i]);
    for (int c = 0; c < d && u.size() > 0; ++c) Y[i][c] += u[faces.dof[i][c]];
  }
  return Y;
}

/// Fills an Interface from the two sides, which have the labels of all pairs.
class InterfaceBuilder {
 public:
  /// of_part: others may know what joins the bodies.
  InterfaceBuilder(const std::vector<mortar::LabelPair>& pairs, bool of_part)
      : all_{}, of_part_(of_part) {
    for (const mortar::LabelPair& labels : pairs) {
      all_.pairs.emplace_back();
      all_.pairs.back().slave.labels = labels.slave;
      all_.pairs.back().master.labels = labels.master;
    }
  }
  template <class FESpaceType>
  void add_slave(const BoundaryNodes<FESpaceType>& side) {
    all_.slave = side.nodes();
    add(side, 0, &mortar::Pair::slave);
    std::vector<int> element;
    for (const SharedNode& n : side.nodes()) element.push_back(n.facets.front().element);
    const CountPointer<FESpaceType> keep(const_cast<FESpaceType*>(&side.space()));
    all_.slave_bodies = [keep, element] {
      const FESpaceType* space = keep;
      const std::vector<Index> of_element = body_of_element(space->Th, Dimension<FESpaceType>::d);
      std::vector<Index> body;
      for (int k : element) body.push_back(of_element[k]);
      return body;
    };
  }
  /// dof_offset: of the master's dofs among those of the call.
  template <class FESpaceType>
  void add_master(const BoundaryNodes<FESpaceType>& side, Index dof_offset) {
    add(side, dof_offset, &mortar::Pair::master);
    if (dof_offset > 0) return;
    count_bodies(side);
    add_vertices_behind(side);
  }
  Interface take() { return std::move(all_); }

 private:
  /// Each pair takes the facets of its labels.
  template <class FESpaceType>
  void add(const BoundaryNodes<FESpaceType>& side, Index dof_offset,
           mortar::Surface mortar::Pair::*which) {
    constexpr int d = Dimension<FESpaceType>::d;
    all_.is_moved = side.placement().is_moved();
    std::vector<Index> number;
    for (const SharedNode& n : side.nodes()) number.push_back(node(n, d, dof_offset));
    for (const BoundaryFacet& f : side.facets()) {
      mortar::Facet facet;
      facet.label = f.label;
      facet.outward = {f.normal.x, f.normal.y, f.normal.z};
      for (std::size_t k = 0; k < f.node.size(); ++k) facet.node[k] = number[f.node[k]];
      for (mortar::Pair& pair : all_.pairs) {
        mortar::Surface& surface = pair.*which;
        if (!std::count(surface.labels.begin(), surface.labels.end(), f.label)) continue;
        surface.quadratic = static_cast<int>(f.node.size()) > d;
        surface.facets.push_back(facet);
      }
    }
  }

  /// The number of a node, a new one if need be.
  Index node(const SharedNode& n, int d, Index dof_offset) {
    const std::array<Index, 3> dof = shifted(dof_offset, d, n.dof);
    const auto [entry, is_new] = number_.emplace(dof[0], static_cast<Index>(all_.X.size()));
    if (is_new) {
      all_.X.emplace_back(n.x.x, n.x.y, n.x.z);
      all_.moved.emplace_back(n.moved.x, n.moved.y, n.moved.z);
      all_.dof.push_back(dof);
    }
    return entry->second;
  }

  /// How many bodies meet at each vertex that both sides have.
  template <class FESpaceType>
  void count_bodies(const BoundaryNodes<FESpaceType>& master) {
    using D = Dimension<FESpaceType>;
    const auto& Th = master.space().Th;
    std::map<long, Index> shared;  // vertex of the mesh -> node
    for (const SharedNode& n : master.nodes()) {
      const Index i = number_.at(n.dof[0]);
      const AdjacentFacet& f = n.facets.front();
      const int corner = corner_at(f.hat, D::d);
      if (i < static_cast<Index>(all_.slave.size()) && corner >= 0)
        shared[Th(f.element, corner)] = i;
    }
    if (shared.empty()) return;
    std::map<Index, std::vector<std::array<Index, 4>>> around;
    for (int k = 0; k < Th.nt; ++k)
      for (int v = 0; v <= D::d; ++v) {
        const auto found = shared.find(Th(k, v));
        if (found == shared.end()) continue;
        std::array<Index, 4> element{{-1, -1, -1, -1}};
        for (int w = 0; w <= D::d; ++w) element[w] = Th(k, w);
        around[found->second].push_back(element);
      }
    for (const auto& [i, elements] : around)
      all_.body_count[i] = mortar::facet_connected_groups(D::d, elements);
  }

  /// Of the elements behind a master that is one body with its slave: the faces of a crack.
  template <class FESpaceType>
  void add_vertices_behind(const BoundaryNodes<FESpaceType>& master) {
    constexpr int d = Dimension<FESpaceType>::d;
    const std::vector<Index> body = body_of_element(master.space().Th, d);
    for (mortar::Pair& pair : all_.pairs) {
      std::set<Index> of_slave;
      for (const mortar::Facet& f : pair.slave.facets)
        of_slave.insert(body[all_.slave[f.node[0]].facets.front().element]);
      std::size_t next = 0;
      for (const BoundaryFacet& f : master.facets()) {
        if (!std::count(pair.master.labels.begin(), pair.master.labels.end(), f.label)) continue;
        mortar::Facet& facet = pair.master.facets[next++];
        if (of_part_ || of_slave.count(body[f.element]))
          facet.behind = node(node_at_vertex(master.placement(), f.element, f.facet), d, 0);
      }
    }
  }

  Interface all_;
  const bool of_part_;
  std::map<Index, Index> number_;  ///< first dof of a node -> its number
};

}  // namespace frictioncg
