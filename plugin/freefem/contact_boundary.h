#pragma once
#include "freefem.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "boundary_node.h"
#include "dimension.h"

namespace frictioncg {

[[noreturn]] inline void refuse_space(const std::string& why) {
  throw IllegalInput(
      "Vh " + why +
      "; contact needs a continuous vector Lagrange space such as [P1,P1], [P2,P2] or "
      "[P1,P1,P1]");
}

/// The nodes of one facet, with the dofs of each component, and whether they are its corners.
struct FacetNodes {
  std::vector<BoundaryNode> node;
  std::vector<bool> corner;

  /// The node at a point of the reference element, a new one if need be.
  std::size_t at(const Fem2D::R3& hat) {
    for (std::size_t k = 0; k < node.size(); ++k) {
      const Fem2D::R3 away = node[k].hat - hat;
      if (std::abs(away.x) + std::abs(away.y) + std::abs(away.z) < 1e-10) return k;
    }
    node.emplace_back().hat = hat;
    corner.push_back(false);
    return node.size() - 1;
  }
};

/// Refuses traces for which the laws are not written.
template <class FESpaceType>
void check_trace(const FacetNodes& facet) {
  using D = Dimension<FESpaceType>;
  if (facet.node.empty()) refuse_space("has no degree of freedom on the boundary");
  for (const BoundaryNode& n : facet.node)
    for (int c = 0; c < D::d; ++c)
      if (n.point.dof[c] < 0) refuse_space("mixes elements whose components have different nodes");
  if (D::known_trace(facet.node.size())) return;
  std::ostringstream m;
  m << "has " << facet.node.size() << " nodes on each boundary " << D::facet_name
    << ", where the laws of contact are written for " << D::known_counts;
  refuse_space(m.str());
}

/// The nodes of one facet: dofs of each component, grouped by the interpolation points they share;
/// weights for a facet of measure 1.
template <class FESpaceType>
std::vector<BoundaryNode> facet_nodes(const typename Dimension<FESpaceType>::Element& K,
                                      int facet) {
  using D = Dimension<FESpaceType>;
  const Interpolation ip = D::interpolation(K);
  std::map<int, int> uses;  // dof -> interpolation points it is made from
  for (int i : ip.dof) ++uses[i];
  FacetNodes found;
  for (std::size_t k = 0; k < ip.dof.size(); ++k) {
    const int i = ip.dof[k];
    if (!D::on_facet(facet, K.DFOnWhat(i))) continue;
    if (uses[i] != 1 || ip.coefficient[k] != 1)
      refuse_space("has degrees of freedom that are not nodal values");
    const Fem2D::R3& hat = ip.hat[ip.point[k]];
    const std::size_t at = found.at(hat);
    found.node[at].x = D::position(K, hat);
    found.node[at].point.dof[ip.component[k]] = K(i);
    found.corner[at] = D::is_corner(K.DFOnWhat(i));
  }
  check_trace<FESpaceType>(found);
  for (std::size_t k = 0; k < found.node.size(); ++k)
    found.node[k].weight = D::share(found.node.size(), found.corner[k]);
  return std::move(found.node);
}

/// Collects the contact nodes facet by facet.
template <class FESpaceType>
class ContactNodes {
  using D = Dimension<FESpaceType>;

 public:
  explicit ContactNodes(const FESpaceType& Vh) : Vh_(Vh) {}

  /// Adds the facets of a label, once; a node keeps the label that came first.
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

  std::vector<BoundaryNode> take() { return std::move(nodes_); }

 private:
  void add(long label, int k, int facet) {
    const typename D::Element K(Vh_[k]);
    const Fem2D::R3 normal = D::normal(K, facet);
    const double measure = Norme2(normal);
    for (BoundaryNode& n : facet_nodes<FESpaceType>(K, facet)) {
      if (!D::outer(Vh_.Th, k, facet)) refuse_inside(label, n);
      const auto [entry, is_new] = node_of_dof_.emplace(n.point.dof[0], nodes_.size());
      const double share = measure * n.weight;
      if (is_new) {
        n.label = label;
        n.element = k;
        n.facet = facet;
        n.weight = 0;
        nodes_.push_back(std::move(n));
      }
      BoundaryNode& node = nodes_[entry->second];
      node.weight += share;
      node.facets.push_back({label, normal});
    }
  }

  [[noreturn]] void refuse_absent(long label) const {
    std::set<long> present;
    for (int ib = 0; ib < D::facets(Vh_.Th); ++ib) present.insert(D::label(Vh_.Th, ib));
    std::ostringstream s;
    s << "label " << label << " is not on the boundary of the mesh, which has the labels";
    for (long p : present) s << " " << p;
    throw IllegalInput(s.str());
  }
  [[noreturn]] static void refuse_inside(long label, const BoundaryNode& n) {
    throw IllegalInput("label " + std::to_string(label) + " lies inside the body at " +
                       coordinates(n.x, D::d) + ", with elements on both sides of its " +
                       D::facet_name + "s; an obstacle touches the outer boundary only");
  }

  const FESpaceType& Vh_;
  std::set<long> labels_;
  std::map<int, std::size_t> node_of_dof_;  // first dof of a node -> its place in nodes_
  std::vector<BoundaryNode> nodes_;
};

/// The mean of the facets' outward normals, weighted by their measure, of the label that the node
/// belongs to; 0 where they cancel.
inline Fem2D::R3 mean_normal(const BoundaryNode& node) {
  Fem2D::R3 sum;
  double total = 0;
  for (const AdjacentFacet& f : node.facets) {
    if (f.label != node.label) continue;
    sum += f.normal;
    total += Norme2(f.normal);
  }
  const double length = Norme2(sum);
  return length > 1e-10 * total ? sum / length : Fem2D::R3();
}

/// The contact nodes of the given labels. A node shared by two labels belongs to the one listed
/// first, and takes its normal from there; within a label the normals of its facets are averaged,
/// weighted by their measure.
template <class FESpaceType>
std::vector<BoundaryNode> contact_nodes(const FESpaceType& Vh, const std::vector<long>& labels) {
  using D = Dimension<FESpaceType>;
  if (Vh.N != D::d) {
    std::ostringstream s;
    s << "has " << Vh.N << " component" << (Vh.N > 1 ? "s" : "") << " on a " << D::d << "D mesh";
    refuse_space(s.str());
  }
  ContactNodes<FESpaceType> all(Vh);
  for (long label : labels) all.add(label);
  std::vector<BoundaryNode> nodes = all.take();
  for (BoundaryNode& n : nodes) {
    const Fem2D::R3 N = mean_normal(n);
    n.point.normal = {N.x, N.y, N.z};
  }
  return nodes;
}

}  // namespace frictioncg
