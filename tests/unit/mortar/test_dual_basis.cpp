#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <random>

#include "core/assembly/mortar/integration.h"

using namespace frictioncg;
using namespace frictioncg::mortar;

namespace {

/// int over a polygon of lambda_1^p lambda_2^q, by the exact formula on triangles seen from 0.
Real monomial_over_simplex(int d, int p, int q) {
  const auto factorial = [](int n) { return std::tgamma(n + 1.); };
  if (d == 2) return 1. / (p + 1);
  return factorial(p) * factorial(q) / factorial(p + q + 2);
}

Polygon random_part(int d, std::mt19937& random) {
  std::uniform_real_distribution<Real> uniform(-1, 1);
  Polygon part;
  while (part.empty() || extent(part) < 1e-3) {
    part = reference_facet(d);
    for (int k = 0; k < 3 && !part.empty(); ++k) {
      Affine f;
      f.g = Vec2(uniform(random), d == 2 ? 0 : uniform(random));
      f.c = -f.g.dot(Vec2(1. / 3, d == 2 ? 0 : 1. / 3)) + 0.3 * uniform(random);
      part = cut(part, f);
    }
  }
  return part;
}

}  // namespace

TEST(MortarQuadrature, IntegratesDegreeFourOverTheReferenceFacet) {
  for (int d : {2, 3}) {
    std::vector<QuadraturePoint> points;
    quadrature(reference_facet(d), points);
    for (int p = 0; p <= 4; ++p)
      for (int q = 0; p + q <= 4 && (d == 3 || q == 0); ++q) {
        Real sum = 0;
        for (const auto& point : points)
          sum += point.weight * std::pow(point.xi[0], p) * std::pow(point.xi[1], q);
        EXPECT_NEAR(sum, monomial_over_simplex(d, p, q), 1e-16) << d << p << q;
      }
  }
}

TEST(MortarClipping, APolygonIsTheSumOfItsPartsInsideAndOutsideAFacet) {
  std::mt19937 random(5);
  std::uniform_real_distribution<Real> uniform(-0.6, 1.6);
  for (int d : {2, 3})
    for (int k = 0; k < 200; ++k) {
      const Polygon part = random_part(d, random);
      std::vector<Vec3> X;
      for (int v = 0; v < d; ++v)
        X.push_back(d == 2 ? Vec3(uniform(random), uniform(random), 0)
                           : Vec3(uniform(random), uniform(random), uniform(random)));
      Plane slave;
      slave.normal = d == 2 ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
      slave.B.row(0) = Vec3(1, 0, 0).transpose();
      if (d == 3) slave.B.row(1) = Vec3(0, 1, 0).transpose();
      Facet master;
      master.node = {0, 1, 2, -1, -1, -1};
      const Projection chi = project(d, slave, master, X);
      ASSERT_TRUE(chi.inverts);
      const Polygon common = inside(d, part, chi);
      Real sum = common.empty() ? 0 : extent(common);
      for (const Polygon& piece : outside(d, part, chi)) sum += extent(piece);
      EXPECT_NEAR(sum, extent(part), 1e-14);
      for (const Vec2& xi : common) {  // chi lies on the normal through xi
        Vec3 x = Vec3::Zero();
        for (int v = 0; v < d; ++v) x += chi.at(xi)[v] * X[v];
        EXPECT_GT(chi.at(xi).head(d).minCoeff(), -1e-13);
        EXPECT_LT((slave.B * x - xi).norm(), 1e-13);
        EXPECT_NEAR(slave.normal.dot(x), chi.distance(xi), 1e-13);
      }
    }
}

TEST(MortarDualBasis, IsBiorthogonalAndSumsToOneOnPartsOfAFacetAndWithRemovedNodes) {
  std::mt19937 random(7);
  for (int d : {2, 3})
    for (int trial = 0; trial < 100; ++trial) {
      const Polygon part = random_part(d, random);
      std::vector<QuadraturePoint> points;
      quadrature(part, points);
      Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
      for (const auto& p : points)
        M += p.weight * slave_coordinates(d, p.xi) * slave_coordinates(d, p.xi).transpose();
      // a thin part leaves the lambda nearly dependent: so much of the 16 digits goes
      const auto values = M.topLeftCorner(d, d).jacobiSvd().singularValues();
      const Real rounding = 1e-15 * values[0] / values[d - 1];
      for (int which = 1; which < 1 << d; ++which) {
        std::array<bool, 3> kept{};
        for (int v = 0; v < d; ++v) kept[v] = which >> v & 1;
        const DualBasis dual = dual_basis(d, M, kept);
        const Eigen::Matrix3d products = dual.psi * M;  // int psi_i lambda_k
        Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
        for (int i = 0; i < d; ++i) {
          if (!kept[i]) {
            EXPECT_EQ(dual.psi.row(i).norm() + std::abs(dual.d[i]), 0);
            continue;
          }
          sum += dual.psi.row(i);
          EXPECT_NEAR(dual.d[i], M.col(i).sum(), 1e-16);
          for (int k = 0; k < d; ++k)
            if (kept[k]) {
              EXPECT_NEAR(products(i, k), i == k ? dual.d[i] : 0, rounding * dual.d[i]);
            }
        }
        for (int v = 0; v < d; ++v) EXPECT_NEAR(sum[v], 1, rounding);
      }
    }
}

TEST(MortarShapes, TracesSumToOneAndAreNodal) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      const int n = nodes_of_facet(d, quadratic);
      for (int k = 0; k < n; ++k) {
        Vec3 at = Vec3::Zero();
        if (k < d) {
          at[k] = 1;
        } else {
          const auto [a, b] = edge_ends(d, k - d);
          at[a] = at[b] = 0.5;
        }
        const Shape phi = shape_functions(d, quadratic, at);
        for (int l = 0; l < 6; ++l) EXPECT_EQ(phi[l], l == k ? 1 : 0);
      }
      const Shape phi =
          shape_functions(d, quadratic, Vec3(0.3, d == 2 ? 0.7 : 0.5, d == 2 ? 0 : 0.2));
      Real sum = 0;
      for (Real value : phi) sum += value;
      EXPECT_NEAR(sum, 1, 1e-15);
    }
}
