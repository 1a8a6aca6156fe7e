#include "assembly/turning_normals.h"

#include "linear_algebra.h"

namespace frictioncg {

namespace {

/// sym(dn/dx) along a facet, with nothing across it: n = dn/dx (x - mean) by least squares, and a
/// constant.
Eigen::Matrix3d slope(const std::vector<const ObstaclePoint*>& points) {
  constexpr Real across = 1e-6;     // of the largest distance: what leaves the facet is rounding
  constexpr Real rounding = 1e-12;  // of normals that are those of a plane
  DenseMatrix x(points.size(), 3), n(points.size(), 3);
  for (std::size_t k = 0; k < points.size(); ++k) {
    x.row(Index(k)) = points[k]->x.transpose();
    n.row(Index(k)) = points[k]->normal.transpose();
  }
  if ((n.rowwise() - n.row(0)).rowwise().norm().maxCoeff() <= rounding)
    return Eigen::Matrix3d::Zero();
  x.rowwise() -= x.colwise().mean().eval();
  const Eigen::Matrix3d slope = least_squares(x, n, across);
  return (slope + slope.transpose()) / 2;
}

}  // namespace

std::vector<Eigen::Matrix3d> turning_of_normals(const std::vector<ObstaclePoint>& points) {
  std::map<std::size_t, std::vector<const ObstaclePoint*>> on_facet;
  for (const ObstaclePoint& p : points)
    for (const auto& f : p.facets) on_facet[f.facet].push_back(&p);
  std::map<std::size_t, Eigen::Matrix3d> of_facet;
  for (const auto& [facet, at] : on_facet) of_facet[facet] = slope(at);
  std::vector<Eigen::Matrix3d> turning;
  for (const ObstaclePoint& p : points) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Real total = 0;
    for (const auto& f : p.facets) {
      sum += f.share * of_facet[f.facet];
      total += f.share;
    }
    const Eigen::Matrix3d along = Eigen::Matrix3d::Identity() - p.normal * p.normal.transpose();
    turning.push_back(along * sum * along / (total > 0 ? total : 1));
  }
  return turning;
}

Eigen::Matrix3d positive_part(const Eigen::Matrix3d& M) {
  const Eigenpairs found = eigenpairs(M);
  return found.vectors * found.values.cwiseMax(0).asDiagonal() * found.vectors.transpose();
}

}  // namespace frictioncg
