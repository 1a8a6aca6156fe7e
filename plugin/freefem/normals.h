#pragma once
#include "freefem.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "boundary_node.h"

namespace frictioncg {

/// Facets whose normals differ by more than this are different obstacles at the node they share.
/// Coarse meshes of a circle (12 edges) turn by as much from edge to edge.
constexpr double corner_angle = 30 * M_PI / 180;

/// Facets at one node that share a normal.
using FacetGroup = std::vector<AdjacentFacet>;

/// The mean outward normal, weighted by the measure of the facets; 0 where they cancel.
inline Fem2D::R3 mean_normal(const FacetGroup& group,
                             Fem2D::R3 AdjacentFacet::*normal = &AdjacentFacet::normal) {
  Fem2D::R3 sum;
  double total = 0;
  for (const AdjacentFacet& f : group) {
    sum += f.*normal;
    total += Norme2(f.*normal);
  }
  const double length = Norme2(sum);
  return length > 1e-10 * total ? sum / length : Fem2D::R3();
}

inline bool similar(const Fem2D::R3& m, const Fem2D::R3& n) {
  return (m, n) >= std::cos(corner_angle) * (1 - 1e-9) * Norme2(m) * Norme2(n);
}

/// Facets in groups: two are in one group where a chain of facets leads from one to the other by
/// angles up to corner_angle, whatever their labels. The order of labels does not matter.
inline std::vector<FacetGroup> groups_by_normal(const FacetGroup& facets) {
  std::vector<FacetGroup> groups;
  for (const AdjacentFacet& f : facets) {
    FacetGroup joined{f};
    for (std::size_t g = groups.size(); g-- > 0;) {
      const bool near = std::any_of(groups[g].begin(), groups[g].end(), [&](const auto& other) {
        return similar(other.deciding, f.deciding);
      });
      if (!near) continue;
      joined.insert(joined.begin(), groups[g].begin(), groups[g].end());
      groups.erase(groups.begin() + static_cast<long>(g));
    }
    groups.push_back(std::move(joined));
  }
  return groups;
}

/// Whether the normals of the groups can all be obeyed: at most d, none nearly a combination of the
/// others.
inline bool independent(const std::vector<FacetGroup>& groups, int d) {
  constexpr double thin = 0.05;  // volume of the unit normals; a wedge of 3 degrees
  if (static_cast<int>(groups.size()) > d) return false;
  std::vector<Fem2D::R3> n;
  for (const FacetGroup& g : groups) n.push_back(mean_normal(g, &AdjacentFacet::deciding));
  if (n.size() < 2) return true;
  const double volume = n.size() == 2 ? Norme2(n[0] ^ n[1]) : std::abs((n[0] ^ n[1], n[2]));
  return volume > thin;
}

/// The contact points of a node: one per normal. Where there are more normals than the node can
/// obey (the tip of a pyramid), one mean normal stands for all.   normal_of: group -> FanNormal
template <class NormalOf>
void add_points(const SharedNode& node, int d, std::vector<BoundaryNode>& points,
                const NormalOf& normal_of) {
  std::vector<FacetGroup> groups = groups_by_normal(node.facets);
  const bool averaged = !independent(groups, d);
  if (averaged) groups = {node.facets};
  const Fem2D::R3 mean = mean_normal(node.facets);
  for (const FacetGroup& group : groups) {
    const AdjacentFacet& first = group.front();
    BoundaryNode p;
    p.point.dof = node.dof;
    if (averaged) {
      p.point.normal = {mean.x, mean.y, mean.z};
    } else {
      const auto found = normal_of(group);
      p.point.normal = {found.normal[0], found.normal[1], found.normal[2]};
      p.turn = found.turn;
    }
    p.x = node.x + node.aside;
    p.moved = node.moved;
    p.aside = node.aside;
    p.label = first.label;
    p.element = first.element;
    p.facet = first.facet;
    p.hat = first.hat;
    p.mean = mean;
    p.averaged = averaged;
    p.facets = group;
    for (const AdjacentFacet& f : group) p.weight += f.share;
    points.push_back(p);
  }
}

/// Given normals may agree where those of the mesh do not: keeps one point for each normal of a
/// node, as they are where that is decided. The points of a node follow each other.
inline void merge_equal_normals(std::vector<BoundaryNode>& points) {
  std::vector<BoundaryNode> kept;
  for (const BoundaryNode& p : points) {
    std::size_t q = kept.size();
    bool merged = false;
    while (!merged && q-- > 0 && kept[q].point.dof[0] == p.point.dof[0])
      if (similar(as_R3(kept[q].deciding().point.normal), as_R3(p.deciding().point.normal))) {
        kept[q].weight += p.weight;
        merged = true;
      }
    if (!merged) kept.push_back(p);
  }
  points = std::move(kept);
}

}  // namespace frictioncg
