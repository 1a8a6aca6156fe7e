#pragma once
#include "freefem.h"

#include "../core/assembly/mortar/surface.h"
#include "../core/assembly/slippable.h"
#include "../core/assembly/smooth_normals.h"
#include "boundary_node.h"
#include "normals.h"

namespace frictioncg {

inline Eigen::Vector3d as_vector(const Fem2D::R3& x) { return Eigen::Vector3d(x.x, x.y, x.z); }

/// The normals of the smooth surface that the facets of a contact boundary stand for.
class SurfaceNormals {
 public:
  SurfaceNormals(int d, const Boundary& boundary)
      : d_(d), nodes_(boundary.nodes), facets_(boundary.facets), fan_at_(facets_.size()) {
    Faceted surface;
    surface.d = d;
    for (const SharedNode& n : nodes_) surface.X.push_back(as_vector(n.x));
    for (const BoundaryFacet& f : facets_) {
      Faceted::Facet& facet = surface.facets.emplace_back();
      facet.normal = as_vector(f.normal).normalized();
      for (int v = 0; v < d; ++v) facet.vertex[v] = static_cast<Index>(f.node[v]);
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (edge_of(i, nodes_[i].facets.front().place) < 0) add_fans(i, surface);
    normal_ = smooth_normals(surface);
  }

  /// That of a node's facets; in the middle of a P2 edge, that of the chord or of the arc.
  FanNormal operator()(std::size_t i, const FacetGroup& group) const {
    const std::size_t f = group.front().place;
    const int edge = edge_of(i, f);
    if (edge < 0) return at(f, vertex_of(i, f));
    const auto [a, b] = mortar::edge_ends(d_, edge);
    const FanNormal &at_a = at(f, a), &at_b = at(f, b);
    FanNormal found;
    found.normal = as_vector(mean_normal(group));
    found.turn = std::min(at_a.turn, at_b.turn);
    if (d_ == 3 && found.turn > 0)
      found.normal = arc_normal(
          at_a.normal, at_b.normal,
          as_vector(nodes_[facets_[f].node[b]].x - nodes_[facets_[f].node[a]].x), found.normal);
    return found;
  }

 private:
  void add_fans(std::size_t i, Faceted& surface) {
    for (const FacetGroup& group : groups_by_normal(nodes_[i].facets)) {
      Fan fan;
      fan.vertex = static_cast<Index>(i);
      fan.mean = as_vector(mean_normal(group));
      for (const AdjacentFacet& f : group) {
        fan.facets.push_back(static_cast<Index>(f.place));
        fan_at_[f.place][vertex_of(i, f.place)] = surface.fans.size();
      }
      surface.fans.push_back(std::move(fan));
    }
  }
  const FanNormal& at(std::size_t facet, int vertex) const {
    return normal_[fan_at_[facet][vertex]];
  }
  int vertex_of(std::size_t i, std::size_t facet) const {
    const auto& node = facets_[facet].node;
    return static_cast<int>(std::find(node.begin(), node.end(), i) - node.begin());
  }
  /// The edge of the facet in whose middle a node lies, or -1.
  int edge_of(std::size_t i, std::size_t facet) const {
    return std::max(vertex_of(i, facet) - d_, -1);
  }

  const int d_;
  const std::vector<SharedNode>& nodes_;
  const std::vector<BoundaryFacet>& facets_;
  std::vector<std::array<std::size_t, 3>> fan_at_;  ///< of each facet, at its vertices
  std::vector<FanNormal> normal_;                   ///< of each fan
};

/// The contact points of the first `count` nodes: one per node and normal (normals.h).
inline std::vector<BoundaryNode> contact_points(int d, const Boundary& boundary,
                                                std::size_t count) {
  const SurfaceNormals normal(d, boundary);
  std::vector<BoundaryNode> points;
  for (std::size_t i = 0; i < count; ++i)
    add_points(boundary.nodes[i], d, points,
               [&](const FacetGroup& group) { return normal(i, group); });
  return points;
}

/// The same boundary where the increment began tells which facets are one obstacle to a node.
inline void decide_by(const Boundary& begun, Boundary& boundary) {
  for (std::size_t i = 0; i < boundary.nodes.size(); ++i)
    for (std::size_t f = 0; f < boundary.nodes[i].facets.size(); ++f)
      boundary.nodes[i].facets[f].deciding = begun.nodes[i].facets[f].normal;
}

/// Points with what they were where the increment began, which is decided by decide_by.
inline void remember(const std::vector<BoundaryNode>& begun, std::vector<BoundaryNode>& points) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    points[k].begun = std::make_shared<BoundaryNode>(begun[k]);
    points[k].begun->is_begun = true;
  }
}

/// Whether points are on a curved surface, where that is decided.
inline bool any_curved(const std::vector<BoundaryNode>& points) {
  return std::any_of(points.begin(), points.end(),
                     [](const auto& p) { return p.deciding().turn > 0; });
}

/// Whether any of them has been elsewhere where the increment began.
inline bool any_begun(const std::vector<BoundaryNode>& points) {
  return std::any_of(points.begin(), points.end(),
                     [](const auto& p) { return p.begun != nullptr; });
}

/// Makes motions that each body's points do not resist, as far as the mesh can tell, tangential
/// exactly, by follow(body, points, decided), which returns how many there are (slippable.h).
/// body: of each point, 0 .. bodies - 1; has_begun: the increment, elsewhere, where it is decided
/// how many there are
template <class Follow>
void follow_by_body(int d, const std::vector<Index>& body, Index bodies, bool has_begun,
                    std::vector<BoundaryNode>& points, const Follow& follow) {
  std::vector<std::vector<std::size_t>> of_body(bodies);
  for (std::size_t k = 0; k < points.size(); ++k) of_body[body[k]].push_back(k);
  const auto as_normal = [](const BoundaryNode& p) -> PointNormal {
    return {as_vector(p.x), as_vector(as_R3(p.point.normal)), p.weight, p.turn};
  };
  for (Index b = 0; b < bodies; ++b) {
    const std::vector<std::size_t>& own = of_body[b];
    std::vector<PointNormal> normals, begun;
    for (std::size_t k : own) {
      normals.push_back(as_normal(points[k]));
      if (has_begun) begun.push_back(as_normal(*points[k].begun));
    }
    DecidedCount decided;
    if (has_begun) decided = follow(b, begun, DecidedCount());
    if (follow(b, normals, decided) == 0) continue;
    for (std::size_t k = 0; k < own.size(); ++k)
      for (int c = 0; c < d; ++c) points[own[k]].point.normal[c] = normals[k].normal[c];
  }
}

/// The motions that the points of each body tell themselves.
inline void follow_motions(int d, const std::vector<Index>& body, Index bodies, bool has_begun,
                           std::vector<BoundaryNode>& points, const SumOverProcesses& sum = {}) {
  follow_by_body(d, body, bodies, has_begun, points, [&](Index, auto& own, DecidedCount decided) {
    return follow_slippable_motions(d, own, decided, sum);
  });
}

}  // namespace frictioncg
