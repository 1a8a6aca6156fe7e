#include "assembly/turning_normals.h"

#include "linear_algebra.h"

namespace frictioncg {

namespace {

/// dn/dx along a facet, with nothing across it: n - mean = dn/dx (x - mean) by least squares.
Eigen::Matrix3d slope(const std::vector<const ObstaclePoint*>& points) {
  constexpr Real flat = 1e-6;  // of the largest distance: what lies across the facet is rounding
  Vec3 x = Vec3::Zero(), n = Vec3::Zero();
  for (const ObstaclePoint* p : points) {
    x += p->x / static_cast<Real>(points.size());
    n += p->normal / static_cast<Real>(points.size());
  }
  DenseMatrix from_x(points.size(), 3), from_n(points.size(), 3);
  for (std::size_t k = 0; k < points.size(); ++k) {
    from_x.row(Index(k)) = (points[k]->x - x).transpose();
    from_n.row(Index(k)) = (points[k]->normal - n).transpose();
  }
  return least_squares(from_x, from_n, flat).transpose();
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
    turning.push_back(along * (sum + sum.transpose()) * along / (2 * (total > 0 ? total : 1)));
  }
  return turning;
}

}  // namespace frictioncg
