#pragma once
#include "freefem.h"

#include "../core/assembly/mortar/surface.h"
#include "boundary_node.h"
#include "placement.h"
#include "surface_normals.h"

namespace frictioncg {

/// Why a space cannot be used; the name of the space is put before it.
struct UnfitSpace : IllegalInput {
  using IllegalInput::IllegalInput;
};

[[noreturn]] inline void refuse_space(const std::string& why) {
  throw UnfitSpace(why +
                   "; contact needs a continuous vector Lagrange space such as [P1,P1], [P2,P2] or "
                   "[P1,P1,P1]");
}

/// A space under its name in messages, and what one of its labels inside a body is told.
template <class FESpaceType>
struct NamedSpace {
  const Placement<FESpaceType>& Vh;
  const char* name;
  const char* mesh;
  const char* inside;
};

constexpr const char* obstacle_inside = "an obstacle touches the outer boundary only";
constexpr const char* pair_inside =
    "contact of two bodies needs two faces there, and meshes that were merged, as + does with near "
    "vertices, have none: use one space per mesh, or join them apart and move them back with "
    "movemesh, in 3D with cleanmesh=false";

/// The labels that a mesh's boundary has.
template <class FESpaceType>
std::set<long> labels_of_boundary(const FESpaceType& Vh) {
  using D = Dimension<FESpaceType>;
  std::set<long> labels;
  for (int ib = 0; ib < D::facets(Vh.Th); ++ib) labels.insert(D::label(Vh.Th, ib));
  return labels;
}

/// The nodes of one facet: dofs of each component, grouped by the interpolation points they share.
struct FacetNodes {
  struct Node {
    std::array<Index, 3> dof{{-1, -1, -1}};
    Fem2D::R3 x, hat;
    bool corner = false;
  };
  std::vector<Node> node;

  /// The node at a point of the reference element, a new one if need be.
  Node& at(const Fem2D::R3& hat) {
    for (Node& n : node) {
      const Fem2D::R3 away = n.hat - hat;
      if (std::abs(away.x) + std::abs(away.y) + std::abs(away.z) < 1e-10) return n;
    }
    node.emplace_back().hat = hat;
    return node.back();
  }
};

/// The nodes of a facet in the order of BoundaryFacet::node.
inline std::vector<std::size_t> in_order(const FacetNodes& facet, int d) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < facet.node.size(); ++k)
    if (facet.node[k].corner) order.push_back(k);
  if (facet.node.size() == order.size()) return order;
  for (int edge = 0; edge < mortar::edges_of_facet(d); ++edge) {
    const auto [a, b] = mortar::edge_ends(d, edge);
    const Fem2D::R3 ends = facet.node[order[a]].hat + facet.node[order[b]].hat;
    for (std::size_t k = 0; k < facet.node.size(); ++k)
      if (Norme2(2. * facet.node[k].hat - ends) < 1e-10) order.push_back(k);
  }
  return order;
}

/// Refuses traces for which the laws are not written.
template <class FESpaceType>
void check_trace(const FacetNodes& facet) {
  using D = Dimension<FESpaceType>;
  if (facet.node.empty()) refuse_space("has no degree of freedom on the boundary");
  for (const FacetNodes::Node& n : facet.node)
    for (int c = 0; c < D::d; ++c)
      if (n.dof[c] < 0) refuse_space("mixes elements whose components have different nodes");
  if (D::known_trace(facet.node.size())) return;
  std::ostringstream m;
  m << "has " << facet.node.size() << " nodes on each boundary " << D::facet_name
    << ", where the laws of contact are written for " << D::known_counts;
  refuse_space(m.str());
}

template <class FESpaceType>
FacetNodes facet_nodes(const Placement<FESpaceType>& Vh, int k, int facet) {
  using D = Dimension<FESpaceType>;
  const typename D::Element K(Vh.space()[k]);
  Interpolation ip;
  D::interpolate(K, ip);
  std::map<int, int> uses;  // dof -> interpolation points it is made from
  for (int i : ip.dof) ++uses[i];
  FacetNodes found;
  for (std::size_t e = 0; e < ip.dof.size(); ++e) {
    const int i = ip.dof[e];
    if (!D::on_facet(facet, K.DFOnWhat(i))) continue;
    if (uses[i] != 1 || ip.coefficient[e] != 1)
      refuse_space("has degrees of freedom that are not nodal values");
    const Fem2D::R3& hat = ip.hat[ip.point[e]];
    FacetNodes::Node& n = found.at(hat);
    n.x = Vh(k, hat);
    n.dof[ip.component[e]] = K(i);
    n.corner = D::is_corner(K.DFOnWhat(i));
  }
  check_trace<FESpaceType>(found);
  return found;
}

/// A node of a boundary with a label: its share is the integral of its trace.
struct LabelledNode {
  long label = 0;
  std::array<Index, 3> dof{{-1, -1, -1}};
  Real share = 0;  ///< [length^(d-1)]
  int space = 0;   ///< the second of two: 1
};

/// The nodes of all facets that have labels.
template <class Space>
std::vector<LabelledNode> labelled_nodes(const Placement<Space>& Vh) {
  using D = Dimension<Space>;
  const typename D::Mesh& Th = Vh.mesh();
  std::vector<LabelledNode> all;
  for (int ib = 0; ib < D::facets(Th); ++ib) {
    int facet;
    const int k = Th.BoundaryElement(ib, facet);
    const Real measure = Norme2(D::normal(Vh.vertices(k), facet));
    const FacetNodes nodes = facet_nodes(Vh, k, facet);
    for (const FacetNodes::Node& n : nodes.node)
      all.push_back({D::label(Th, ib), n.dof, measure * D::share(nodes.node.size(), n.corner), 0});
  }
  return all;
}

/// The node at a vertex of an element.
template <class FESpaceType>
SharedNode node_at_vertex(const Placement<FESpaceType>& Vh, int element, int vertex) {
  using D = Dimension<FESpaceType>;
  const typename D::Element K(Vh.space()[element]);
  Interpolation ip;
  D::interpolate(K, ip);
  SharedNode node;
  for (std::size_t k = 0; k < ip.dof.size(); ++k) {
    const Fem2D::R3& hat = ip.hat[ip.point[k]];
    if (corner_at(hat, D::d) != vertex || ip.coefficient[k] != 1) continue;
    node.dof[ip.component[k]] = K(ip.dof[k]);
    node.x = Vh(element, hat);
  }
  node.moved = Vh.moved(node.dof);
  return node;
}

/// Collects the nodes of the contact boundary facet by facet.
template <class FESpaceType>
class BoundaryNodes {
  using D = Dimension<FESpaceType>;

 public:
  BoundaryNodes(const NamedSpace<FESpaceType>& space, const std::vector<long>& labels)
      : space_(space), place_(space.Vh), Vh_(place_.space()) {
    try {
      check_components();
      for (long label : labels) add(label);
    } catch (const UnfitSpace& e) {
      throw IllegalInput(std::string(space.name) + " " + e.what());
    }
  }

  const Placement<FESpaceType>& placement() const { return place_; }
  const FESpaceType& space() const { return Vh_; }
  const std::vector<SharedNode>& nodes() const { return nodes_; }
  const std::vector<BoundaryFacet>& facets() const { return facets_; }

 private:
  void check_components() const {
    if (Vh_.N == D::d) return;
    std::ostringstream s;
    s << "has " << Vh_.N << " component" << (Vh_.N > 1 ? "s" : "") << " on a " << D::d << "D mesh";
    refuse_space(s.str());
  }
  /// Adds the facets of a label, once.
  void add(long label) {
    if (!labels_.insert(label).second) return;
    bool found = false;
    for (int ib = 0; ib < D::facets(Vh_.Th); ++ib) {
      if (D::label(Vh_.Th, ib) != label) continue;
      found = true;
      int facet;
      const int k = Vh_.Th.BoundaryElement(ib, facet);
      add(label, k, facet);
    }
    if (!found) refuse_absent(label);
  }

  void add(long label, int k, int facet) {
    const Fem2D::R3 normal = D::normal(place_.vertices(k), facet);
    const FacetNodes nodes = facet_nodes(place_, k, facet);
    if (!D::outer(Vh_.Th, k, facet)) refuse_inside(label, nodes.node.front().x);
    if (place_.is_inverted(k)) refuse_inverted(label, k, nodes);
    std::vector<std::size_t> place;
    for (const FacetNodes::Node& n : nodes.node) {
      const auto [entry, is_new] = node_of_dof_.emplace(n.dof[0], nodes_.size());
      const Fem2D::R3 aside = place_.is_moved() ? place_.node(k, n.hat, n.dof) - n.x : Fem2D::R3();
      if (is_new) nodes_.push_back({n.dof, n.x, place_.moved(n.dof), aside, {}});
      const double share = Norme2(normal) * D::share(nodes.node.size(), n.corner);
      nodes_[entry->second].facets.push_back({label, k, facet, n.hat, normal, share, facets_.size(),
                                              D::own(nodes.node.size()), normal});
      place.push_back(entry->second);
    }
    facets_.push_back({label, normal, {}, k, facet});
    for (std::size_t n : in_order(nodes, D::d)) facets_.back().node.push_back(place[n]);
  }

  [[noreturn]] void refuse_absent(long label) const {
    std::ostringstream s;
    s << "label " << label << " is not on the boundary of " << space_.mesh
      << ", which has the labels";
    for (long present : labels_of_boundary(Vh_)) s << " " << present;
    throw IllegalInput(s.str());
  }
  [[noreturn]] void refuse_inside(long label, const Fem2D::R3& x) const {
    throw IllegalInput("label " + std::to_string(label) + " lies inside the body at " +
                       coordinates(x, D::d) + ", with elements on both sides of its " +
                       D::facet_name + "s; " + space_.inside);
  }

  /// By the middle of its facet, on the mesh.
  [[noreturn]] void refuse_inverted(long label, int k, const FacetNodes& facet) const {
    Fem2D::R3 middle;
    for (const FacetNodes::Node& n : facet.node)
      if (n.corner) middle += D::position(Vh_.Th, k, n.hat) / D::d;
    throw IllegalInput(place_.moved_by() + " turns the element behind the " + D::facet_name +
                       " at " + coordinates(middle, D::d) + " on label " + std::to_string(label) +
                       " inside out, or makes it flat; take a smaller increment of the load, or a "
                       "part of the step");
  }

  const NamedSpace<FESpaceType> space_;
  const Placement<FESpaceType>& place_;
  const FESpaceType& Vh_;
  std::set<long> labels_;
  std::map<int, std::size_t> node_of_dof_;  // first dof of a node -> its place in nodes_
  std::vector<SharedNode> nodes_;
  std::vector<BoundaryFacet> facets_;
};

/// A space whose boundary an obstacle touches.
template <class FESpaceType>
NamedSpace<FESpaceType> before_obstacle(const Placement<FESpaceType>& Vh, const char* name = "Vh",
                                        const char* mesh = "the mesh") {
  return {Vh, name, mesh, obstacle_inside};
}

/// The contact boundary of the given labels.
template <class FESpaceType>
Boundary boundary_of(const NamedSpace<FESpaceType>& space, const std::vector<long>& labels) {
  const BoundaryNodes<FESpaceType> all(space, labels);
  return {all.nodes(), all.facets()};
}
template <class FESpaceType>
Boundary boundary_of(const Placement<FESpaceType>& Vh, const std::vector<long>& labels) {
  return boundary_of(before_obstacle(Vh), labels);
}

}  // namespace frictioncg
