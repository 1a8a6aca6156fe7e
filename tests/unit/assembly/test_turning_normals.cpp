#include "assembly/turning_normals.h"

#include <gtest/gtest.h>

using namespace frictioncg;

namespace {

/// Points of a grid of nx x ny cells cut in two, in 2D of nx segments (ny = 0), with their facets.
std::vector<ObstaclePoint> grid(int nx, int ny, const std::function<Vec3(Real, Real)>& x,
                                const std::function<Vec3(Real, Real)>& normal) {
  std::vector<ObstaclePoint> points;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const Real u = (i + 0.2 * std::sin(3. * i + j)) / nx, v = Real(j) / std::max(ny, 1);
      points.push_back({x(u, v), normal(u, v), {}});
    }
  std::size_t facets = 0;
  const auto add = [&](std::initializer_list<int> nodes) {
    for (int k : nodes) points[k].facets.push_back({facets, 1. / (1 + facets % 3)});
    ++facets;
  };
  for (int i = 0; i < nx; ++i) {
    if (ny == 0) add({i, i + 1});
    for (int j = 0; j < ny; ++j) {
      const int k = j * (nx + 1) + i;
      add({k, k + 1, k + nx + 2});
      add({k, k + nx + 2, k + nx + 1});
    }
  }
  return points;
}

Vec3 around(Real t) { return Vec3(std::cos(t), std::sin(t), 0); }

}  // namespace

TEST(TurningOfNormals, OfACircleIsItsCurvatureAlongItPositiveInAHollow) {
  static constexpr Real R = 2;
  for (Real side : {1, -1}) {
    const auto points = grid(
        60, 0, [](Real u, Real) { return Vec3(R * around(u)); },
        [&](Real u, Real) { return Vec3(side * around(u)); });
    const std::vector<Eigen::Matrix3d> turning = turning_of_normals(points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3 t = Vec3::UnitZ().cross(points[k].normal);
      EXPECT_LT((turning[k] - side / R * t * t.transpose()).norm(), 1e-4) << k;
    }
  }
}

TEST(TurningOfNormals, OfASphereIsThatOfAllDirectionsAndOfACylinderOfOne) {
  static constexpr Real R = 3;
  const auto ball = [](Real u, Real v) {
    return Vec3(std::cos(v - 0.5) * around(u) + std::sin(v - 0.5) * Vec3::UnitZ());
  };
  const auto tube = [](Real u, Real) { return around(u); };
  const auto on_ball = grid(
      30, 30, [&](Real u, Real v) { return Vec3(R * ball(u, v)); }, ball);
  const auto on_tube = grid(
      30, 5, [&](Real u, Real v) { return Vec3(R * tube(u, v) + v * Vec3::UnitZ()); }, tube);
  const std::vector<Eigen::Matrix3d> of_ball = turning_of_normals(on_ball),
                                     of_tube = turning_of_normals(on_tube);
  for (std::size_t k = 0; k < on_ball.size(); ++k) {
    const Vec3& n = on_ball[k].normal;
    EXPECT_LT((R * of_ball[k] - (Eigen::Matrix3d::Identity() - n * n.transpose())).norm(), 0.02);
  }
  for (std::size_t k = 0; k < on_tube.size(); ++k) {
    const Vec3 t = Vec3::UnitZ().cross(on_tube[k].normal);
    EXPECT_LT((R * of_tube[k] - t * t.transpose()).norm(), 0.02);
  }
}

TEST(TurningOfNormals, AreSymmetricAndInTheTangentPlane) {
  const auto saddle = grid(
      6, 5, [](Real u, Real v) { return Vec3(2 * u, v, 0.3 * u * u - 0.4 * u * v); },
      [](Real u, Real v) { return Vec3(-0.3 * u + 0.2 * v, 0.4 * u, 1).normalized(); });
  const std::vector<Eigen::Matrix3d> turning = turning_of_normals(saddle);
  for (std::size_t k = 0; k < saddle.size(); ++k) {
    EXPECT_GT(turning[k].norm(), 0.1);
    EXPECT_LT((turning[k] - turning[k].transpose()).norm(), 1e-15);
    EXPECT_LT((turning[k] * saddle[k].normal).norm(), 1e-15);
  }
}

TEST(TurningOfNormals, OfAPlaneAndOfAPointAloneIsNone) {
  const auto flat = grid(
      5, 4, [](Real u, Real v) { return Vec3(u, v, 0.3 * u); },
      [](Real u, Real) { return Vec3(-0.3, 1e-15 * u, 1).normalized(); });
  for (const Eigen::Matrix3d& turning : turning_of_normals(flat)) EXPECT_EQ(turning.norm(), 0);
  const std::vector<ObstaclePoint> alone = {{Vec3(1, 2, 0), Vec3::UnitX(), {{7, 0.5}}},
                                            {Vec3(2, 2, 0), Vec3::UnitY(), {}}};
  for (const Eigen::Matrix3d& turning : turning_of_normals(alone)) EXPECT_EQ(turning.norm(), 0);
}
