#pragma once
#include <Eigen/Geometry>

#include "types.h"

namespace frictioncg {

/// The smooth surface near the origin, in axes s1, s2, n:
///   z = (c x^2 + 2 d x y + f y^2 + k z^2)/2,   k = (k1|k1| + k2|k2|)/(|k1| + |k2|),
/// k1, k2 the principal curvatures: circles, spheres and cylinders are among them.
struct Quadric {
  Vec3 normal = Vec3::Zero();  ///< unit, at the origin
  Eigen::Matrix3d curvature =
      Eigen::Matrix3d::Zero();  ///< c s1 s1' + d (s1 s2' + s2 s1') + f s2 s2'
  Real k = 0;

  /// The unit normal at a point of the surface.
  Vec3 normal_at(const Vec3& x) const {
    return (normal - curvature * x - k * normal.dot(x) * normal).normalized();
  }
};

/// A normal further from the mean one than 45 degrees (their cosine) is no normal of a surface.
constexpr Real leaning = M_SQRT1_2;

/// The quadric through the origin that fits the vertices around it best. Its normal is exact on
/// circles, spheres and cylinders, whatever the facets, and of second order in their size on other
/// smooth surfaces; a mean of the facets' normals is of first order, a wedge at each vertex.
///
/// Where the vertices leave the quadric open (one layer of facets), it is curved no more than it
/// has to be. Nothing is returned where no quadric fits within 45 degrees of `mean`.
std::optional<Quadric> osculating_quadric(int d, const std::vector<Vec3>& around, const Vec3& mean);

}  // namespace frictioncg
