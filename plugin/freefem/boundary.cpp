#include "boundary.h"

#include "../core/assembly/mortar/surface.h"
#include "../core/assembly/smooth_normals.h"

namespace frictioncg {

namespace {

/// Facets whose normals differ by more than this are different obstacles at the node they share.
/// Coarse meshes of a circle (12 edges) turn by as much from edge to edge.
constexpr double corner_angle = 30 * M_PI / 180;

/// Facets at one node that share a normal.
using FacetGroup = std::vector<AdjacentFacet>;

/// The mean outward normal, weighted by the measure of the facets; 0 where they cancel.
Vec3 mean_normal(const FacetGroup& group, Vec3 AdjacentFacet::*normal = &AdjacentFacet::normal) {
  Vec3 sum = Vec3::Zero();
  Real total = 0;
  for (const AdjacentFacet& f : group) {
    sum += f.*normal;
    total += length(f.*normal);
  }
  const Real size = length(sum);
  return size > 1e-10 * total ? Vec3(sum / size) : Vec3(Vec3::Zero());
}

bool similar(const Vec3& m, const Vec3& n) {
  return dot(m, n) >= std::cos(corner_angle) * (1 - 1e-9) * length(m) * length(n);
}

/// Facets in groups: two are in one group where a chain of facets leads from one to the other by
/// angles up to corner_angle, whatever their labels. The order of labels does not matter.
std::vector<FacetGroup> groups_by_normal(const FacetGroup& facets) {
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
bool independent(const std::vector<FacetGroup>& groups, int d) {
  constexpr double thin = 0.05;  // volume of the unit normals; a wedge of 3 degrees
  if (static_cast<int>(groups.size()) > d) return false;
  std::vector<Vec3> n;
  for (const FacetGroup& g : groups) n.push_back(mean_normal(g, &AdjacentFacet::deciding));
  if (n.size() < 2) return true;
  const double volume =
      n.size() == 2 ? length(n[0].cross(n[1])) : std::abs(dot(n[0].cross(n[1]), n[2]));
  return volume > thin;
}

/// The normals of the smooth surface that the facets of a contact boundary stand for.
class SurfaceNormals {
 public:
  SurfaceNormals(int d, const Boundary& boundary)
      : d_(d), nodes_(boundary.nodes), facets_(boundary.facets), fan_at_(facets_.size()) {
    Faceted surface;
    surface.d = d;
    surface.is_moved = boundary.is_moved;
    for (const SharedNode& n : nodes_) surface.X.push_back(n.x);
    for (const BoundaryFacet& f : facets_) {
      Faceted::Facet& facet = surface.facets.emplace_back();
      facet.normal = f.normal.normalized();
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
    found.normal = mean_normal(group);
    found.turn = std::min(at_a.turn, at_b.turn);
    if (d_ == 3 && found.turn > 0)
      found.normal =
          arc_normal(at_a.normal, at_b.normal,
                     nodes_[facets_[f].node[b]].x - nodes_[facets_[f].node[a]].x, found.normal);
    return found;
  }

 private:
  void add_fans(std::size_t i, Faceted& surface) {
    for (const FacetGroup& group : groups_by_normal(nodes_[i].facets)) {
      Fan fan;
      fan.vertex = static_cast<Index>(i);
      fan.mean = mean_normal(group);
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

/// Those of contact_points at one node, number i.
void add_points(const SharedNode& node, std::size_t i, int d, const SurfaceNormals& normal,
                std::vector<BoundaryNode>& points) {
  std::vector<FacetGroup> groups = groups_by_normal(node.facets);
  const bool averaged = !independent(groups, d);
  if (averaged) groups = {node.facets};
  const Vec3 mean = mean_normal(node.facets);
  for (const FacetGroup& group : groups) {
    BoundaryNode p{group.front()};
    p.point.dof = node.dof;
    const FanNormal found = averaged ? FanNormal{mean, 0} : normal(i, group);
    p.point.normal = found.normal;
    p.turn = found.turn;
    p.x = node.x + node.aside;
    p.moved = node.moved;
    p.aside = node.aside;
    p.mean = mean;
    p.averaged = averaged;
    p.facets = group;
    for (const AdjacentFacet& f : group) p.weight += f.share;
    points.push_back(p);
  }
}

}  // namespace

std::string place(const BoundaryNode& node, int dimension) {
  return mortar::place(dimension, node.x) + " on label " + std::to_string(node.label);
}

void merge_equal_normals(std::vector<BoundaryNode>& points) {
  std::vector<BoundaryNode> kept;
  for (const BoundaryNode& p : points) {
    std::size_t q = kept.size();
    bool merged = false;
    while (!merged && q-- > 0 && kept[q].point.dof[0] == p.point.dof[0])
      if (similar(kept[q].deciding().point.normal, p.deciding().point.normal)) {
        kept[q].weight += p.weight;
        merged = true;
      }
    if (!merged) kept.push_back(p);
  }
  points = std::move(kept);
}

std::vector<ContactPoint> points_of(const std::vector<BoundaryNode>& nodes) {
  std::vector<ContactPoint> points;
  for (const BoundaryNode& n : nodes) points.push_back(n.point);
  return points;
}

std::vector<BoundaryNode> contact_points(int d, Boundary boundary, const Boundary* begun,
                                         std::size_t count) {
  for (std::size_t i = 0; begun && i < boundary.nodes.size(); ++i)
    for (std::size_t f = 0; f < boundary.nodes[i].facets.size(); ++f)
      boundary.nodes[i].facets[f].deciding = begun->nodes[i].facets[f].normal;
  const SurfaceNormals normal(d, boundary);
  std::vector<BoundaryNode> points;
  for (std::size_t i = 0; i < count; ++i) add_points(boundary.nodes[i], i, d, normal, points);
  if (!begun) return points;
  const std::vector<BoundaryNode> before = contact_points(d, *begun, nullptr, count);
  for (std::size_t k = 0; k < points.size(); ++k)
    points[k].begun = std::make_shared<BoundaryNode>(before[k]);
  return points;
}

bool any_curved(const std::vector<BoundaryNode>& points) {
  return std::any_of(points.begin(), points.end(),
                     [](const auto& p) { return p.deciding().turn > 0; });
}

void follow_by_body(int d, const std::vector<Index>& body, Index bodies, bool has_begun,
                    std::vector<BoundaryNode>& points, const Follow& follow) {
  std::vector<std::vector<std::size_t>> of_body(bodies);
  for (std::size_t k = 0; k < points.size(); ++k) of_body[body[k]].push_back(k);
  const auto as_normal = [](const BoundaryNode& p) -> PointNormal {
    return {p.x, p.point.normal, p.weight, p.turn};
  };
  for (Index b = 0; b < bodies; ++b) {
    const std::vector<std::size_t>& own = of_body[b];
    std::vector<PointNormal> normals, begun;
    for (std::size_t k : own) {
      normals.push_back(as_normal(points[k]));
      if (has_begun) begun.push_back(as_normal(*points[k].begun));
    }
    DecidedSlips decided;
    if (has_begun) decided = follow(b, begun, DecidedSlips());
    if (follow(b, normals, decided) == 0) continue;
    for (std::size_t k = 0; k < own.size(); ++k)
      points[own[k]].point.normal.head(d) = normals[k].normal.head(d);
  }
}

void follow_motions(int d, const std::vector<Index>& body, Index bodies, bool has_begun,
                    std::vector<BoundaryNode>& points, const Processes& all) {
  const auto sum = [&](Real* values, Index count) { all.sum(values, count); };
  follow_by_body(d, body, bodies, has_begun, points,
                 [&](Index, std::vector<PointNormal>& own, DecidedSlips decided) {
                   return follow_slippable_motions(d, own, decided, sum);
                 });
}

}  // namespace frictioncg
