#pragma once
#include <Eigen/Geometry>

#include "../core/assembly/local_system.h"
#include "../core/assembly/slippable.h"
#include "processes.h"

namespace frictioncg {

/// Summed in the order in which FreeFEM's R3 does it.
inline Real dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Real length(const Vec3& a) { return std::sqrt(dot(a, a)); }

class Space;

/// A node on a facet, where expressions are evaluated.
struct FacetPoint {
  const Space* space = nullptr;  ///< that of the element
  long label = 0;
  int element = 0, facet = 0;
  Vec3 hat = Vec3::Zero();  ///< its place in the element
};

/// A facet of the contact boundary as one of its nodes sees it.
struct AdjacentFacet : FacetPoint {
  Vec3 normal = Vec3::Zero();  ///< outward, of the measure of the facet [length^(d-1)]
  double share = 0;            ///< integral of the node's shape function over the facet
  std::size_t place = 0;       ///< among the facets of the boundary
  double own = 0;              ///< Dimension::own of space.cpp
  Vec3 deciding =
      Vec3::Zero();  ///< the normal by which facets are one obstacle to a node, or several
};

/// A node of the mesh on the contact boundary.
struct SharedNode {
  std::array<Index, 3> dof{{-1, -1, -1}};  ///< of each component of the displacement
  Vec3 x = Vec3::Zero();                   ///< on its straight facets
  Vec3 moved = Vec3::Zero();               ///< by the displacement at which the geometry is
  Vec3 aside = Vec3::Zero();               ///< by so much a P2 mid-edge lies beside x
  std::vector<AdjacentFacet> facets;       ///< in the order in which the labels were given
  std::optional<Vec3> other;               ///< its other place, at the seam of a periodic space
};

/// Whether x is another place than y, which the rounding of a facet of that normal does not
/// explain: a period is longer.
inline bool is_elsewhere(const Vec3& x, const Vec3& y, const Vec3& normal, int d) {
  return (x - y).norm() > 1e-3 * std::pow(length(normal), 1. / (d - 1));
}

/// A facet of the contact boundary by its nodes, as places among those of the boundary: the
/// vertices, then the middle of the edge opposite each of them, in 2D of the only edge.
struct BoundaryFacet {
  long label = 0;
  Vec3 normal = Vec3::Zero();  ///< outward, of the measure of the facet [length^(d-1)]
  std::vector<std::size_t> node;
  int element = 0, facet = 0;  ///< the latter has the number of the vertex opposite
};

struct Boundary {
  std::vector<SharedNode> nodes;
  std::vector<BoundaryFacet> facets;
  bool is_moved = false;  ///< by `at`
};

/// A contact point as FreeFEM sees it: one normal of a node, where to evaluate expressions, and its
/// share of the boundary. A node in a corner has several.
struct BoundaryNode : FacetPoint {
  ContactPoint point = {};
  Vec3 x = Vec3::Zero();
  double weight = 0;  ///< integral of its shape function over the facets of this normal, weighted
  Vec3 moved =
      Vec3::Zero();  ///< already, against what it touches: the laws bound it with what follows
  Vec3 aside = Vec3::Zero();  ///< as SharedNode's
  Vec3 slid = Vec3::Zero();   ///< Mortar::slip: what its motion since uold lacks of its slip
  Vec3 mean = Vec3::Zero();  ///< mean outward normal of all facets at the node; 0 where they cancel
  double turn = 0;           ///< angle to its facets, of a curved surface; 0 where that is flat
  bool averaged = false;     ///< it stands for more normals than the node can obey
  std::vector<AdjacentFacet> facets = {};    ///< of this normal; none between two bodies
  std::shared_ptr<BoundaryNode> begun = {};  ///< itself where the increment began; null: here
  const BoundaryNode& deciding() const { return begun ? *begun : *this; }
};

/// A node of a boundary with a label: its share is the integral of its trace.
struct LabelledNode {
  long label = 0;
  std::array<Index, 3> dof{{-1, -1, -1}};
  Real share = 0;  ///< [length^(d-1)]
  int space = 0;   ///< the second of two: 1
};

/// Where a contact node is, for messages.
std::string place(const BoundaryNode& node, int dimension);

/// The contact points of the first `count` nodes, one per node and normal: that of the smooth
/// surface which the facets stand for. Where there are more normals than the node can obey (the tip
/// of a pyramid), one mean normal stands for all. begun: the same boundary where the increment
/// began, which tells which facets are one obstacle to a node, and what the points were there; or
/// null.
std::vector<BoundaryNode> contact_points(int d, Boundary boundary, const Boundary* begun,
                                         std::size_t count);

/// The points alone.
std::vector<ContactPoint> points_of(const std::vector<BoundaryNode>& nodes);

/// Given normals may agree where those of the mesh do not: keeps one point for each normal of a
/// node, as they are where that is decided. The points of a node follow each other.
void merge_equal_normals(std::vector<BoundaryNode>& points);

/// Whether points are on a curved surface, where that is decided.
bool any_curved(const std::vector<BoundaryNode>& points);

/// follow(body, points, decided): which motions the points of the body have been made tangential
/// to.
using Follow = std::function<Slips(Index, std::vector<PointNormal>&, DecidedSlips)>;

/// Makes motions that each body's points do not resist, as far as the mesh can tell, tangential
/// exactly, by `follow` (slippable.h).   body: of each point, 0 .. bodies - 1; has_begun: the
/// increment, elsewhere, where it is decided how many there are
void follow_by_body(int d, const std::vector<Index>& body, Index bodies, bool has_begun,
                    std::vector<BoundaryNode>& points, const Follow& follow);

/// The motions that the points of each body on all processes tell themselves.   Collective.
void follow_motions(int d, const std::vector<Index>& body, Index bodies, bool has_begun,
                    std::vector<BoundaryNode>& points, const Processes& all = Processes());

}  // namespace frictioncg
