#pragma once
#include "types.h"

namespace frictioncg {

/// A point on an obstacle with its outward normal and the facets around it.
struct ObstaclePoint {
  struct Share {
    std::size_t facet;
    Real share;  ///< of the facet, that the point has
  };
  Vec3 x, normal;
  std::vector<Share> facets;
};

/// How the normals of obstacles turn along them at each point: sym(dn/dx) in the plane that n
/// leaves, [1/length], > 0 where the body lies in a hollow. Of a facet it is the slope of least
/// squares of the normals at its points; of a point the mean over its facets.
std::vector<Eigen::Matrix3d> turning_of_normals(const std::vector<ObstaclePoint>& points);
/// Of a symmetric matrix, what its eigenvalues > 0 make of it.
Eigen::Matrix3d positive_part(const Eigen::Matrix3d& M);

}  // namespace frictioncg
