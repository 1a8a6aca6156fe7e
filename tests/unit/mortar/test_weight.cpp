#include <gtest/gtest.h>

#include "../refusal.h"
#include "surfaces.h"
#include "tied.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

/// Flat faces of meshes that do not match, weighted by a + b x at the slave's nodes.
Scene weighted(int d, bool quadratic, Real a, Real b) {
  Scene s = stacked(d, quadratic, 4, 3, 0.3, 0.35);
  for (const Vec3& x : s.bodies.X) s.options.weight.push_back(a + b * x[0]);
  return s;
}

}  // namespace

TEST(MortarWeight, SharesSumUpToItsIntegralAlsoWhereItVanishesAtTheRim) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (Real a : {0.0, 2.0}) {
        const Mortar mortar = weighted(d, quadratic, a, 3).mortar();
        Real sum = 0;
        for (const SlaveNode& node : mortar.nodes()) {
          EXPECT_GT(node.weight, 0);
          sum += node.weight;
        }
        EXPECT_NEAR(sum, a + 1.5, 1e-14);
      }
}

TEST(MortarWeight, LinearFieldsLeaveNoRelativeDisplacementAndForcesBalance) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      const Scene s = weighted(d, quadratic, 0, 1);
      const Mortar mortar = s.mortar();
      Vector u(s.bodies.nodes());
      for (Index i = 0; i < u.size(); ++i) u[i] = 1 + s.bodies.X[i].dot(Vec3(0.4, -0.7, 0.2));
      EXPECT_LT((mortar.relative() * u).lpNorm<Eigen::Infinity>(), 1e-14);
      const Vector f = mortar.relative().transpose() * Vector::Ones(mortar.relative().rows());
      EXPECT_LT(std::abs(f.sum()), 1e-14 * f.lpNorm<1>());
    }
}

TEST(MortarWeight, AUniformPressureIsTheWeightedIntegralOfTheTracesOnBothBodies) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      const Scene s = weighted(d, quadratic, 0.5, 1);
      const Mortar mortar = s.mortar();
      Vector y(mortar.relative().rows());
      for (Index k = 0; k < y.size(); ++k) y[k] = mortar.nodes()[k].weight;
      const Vector f = mortar.relative().transpose() * y;
      for (bool master : {false, true}) {  // against quadratic fields with known integrals
        const Surface& side = master ? s.pairs[0].master : s.pairs[0].slave;
        std::vector<char> seen(s.bodies.X.size(), 0);
        Real virtual_work = 0;
        for (const Facet& facet : side.facets)
          for (int k = 0; k < nodes_of_facet(d, quadratic); ++k) {
            const Index i = facet.node[k];
            if (seen[i]) continue;
            seen[i] = 1;
            const Real x = s.bodies.X[i][0];
            virtual_work += f[i] * (quadratic ? x * x : x);
          }
        // int (1/2 + x) x = 7/12, int (1/2 + x) x^2 = 5/12
        EXPECT_NEAR(virtual_work, (master ? -1. : 1.) * (quadratic ? 5 : 7) / 12, 1e-14);
      }
    }
}

TEST(MortarWeight, AFactorChangesSharesAlone) {
  const Scene one = weighted(3, true, 1, 0), seven = weighted(3, true, 7, 0);
  const Mortar a = one.mortar(), b = seven.mortar();
  EXPECT_LT(Matrix(a.relative() - b.relative()).norm(), 1e-13);
  for (std::size_t k = 0; k < a.nodes().size(); ++k) {
    EXPECT_NEAR(7 * a.nodes()[k].weight, b.nodes()[k].weight, 1e-14);
    EXPECT_NEAR(a.nodes()[k].gap, b.nodes()[k].gap, 1e-15);
  }
}

TEST(MortarWeight, DistancesOfMidEdgesDoNotDependOnIt) {
  Surfaces s(2, true);
  s.pairs[0].slave = s.sheet(
      4, -1, [](const Vec3& x) { return Vec3(x[0], 0.1 + 0.2 * x[0], 0); }, 2);
  s.pairs[0].master = s.sheet(3, 1, same, 1);
  s.options.normals.assign(s.nodes.X.size(), Vec3(0.2, -1, 0));
  const Mortar plain = s.mortar();
  for (const Vec3& x : s.nodes.X) s.options.weight.push_back(x[0]);
  const Mortar mortar = s.mortar();
  ASSERT_EQ(mortar.edges().size(), plain.edges().size());
  for (std::size_t k = 0; k < mortar.edges().size(); ++k)
    EXPECT_NEAR(mortar.edges()[k].distance, plain.edges()[k].distance, 1e-14);
}

TEST(MortarWeight, OfNothingOnAWholeFacetIsRefusedWhereTheFacetFacesTheMaster) {
  Scene s = weighted(2, false, 1, 0);
  for (std::size_t i = 0; i < s.bodies.X.size(); ++i)
    if (s.bodies.X[i][0] < 0.6) s.options.weight[i] = 0;
  const std::string text = frictioncg::test::refusal([&] { s.mortar(); });
  EXPECT_EQ(text.find("weight = 0 on a whole facet of label"), 0u) << text;
}
