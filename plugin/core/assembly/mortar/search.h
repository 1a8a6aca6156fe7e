#pragma once
#include <Eigen/Geometry>

#include "assembly/mortar/surface.h"

namespace frictioncg::mortar {

/// Facets face each other where the cosine of their normals is below this.
constexpr Real facing = -0.1;
/// Where the cosine is above this they hardly do, and a face beside that does it better has the law.
constexpr Real hardly = -0.5;

/// A binary tree over facets, by boxes and by cones of normals: built in O(n log n), and a facet
/// finds those before it without a look at the rest.
class FacetTree {
 public:
  /// planes: one per facet; both are only referred to.
  FacetTree(int d, const std::vector<Facet>& facets, const std::vector<Plane>& planes,
            const std::vector<Vec3>& X);

  /// What to look for along the normal of a facet.
  struct Column {
    const Plane& base;
    Real behind, ahead;  ///< signed distances from the base along its normal [length]
    bool only_facing;    ///< else facets of any direction
  };
  /// The facets whose box meets the column over `base`: a superset of those that overlap it.
  void find(const Column& column, std::vector<Index>& found) const;

  /// The facet whose box is nearest to x, and its distance [length].
  Real nearest(const Vec3& x) const;

  std::size_t visited() const { return visited_; }  ///< nodes of the tree that find() looked at

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    Vec3 axis = Vec3::Zero();
    Real angle = 0;              ///< half angle of the cone of normals
    Index begin = 0, end = 0;    ///< of order_
    Index left = -1, right = -1; /* leaf: -1 */
  };
  Index build(Index begin, Index end);
  void bound(Node& node) const;
  bool may_meet(const Node& node, const Column& column) const;

  const std::vector<Plane>& planes_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
  mutable std::size_t visited_ = 0;
};

}  // namespace frictioncg::mortar
