#include <gtest/gtest.h>

#include "surfaces.h"
#include "tied.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

/// Nodal values of a + b.x
Vector linear(const MeshedBodies& bodies) {
  Vector u(bodies.nodes());
  for (Index i = 0; i < u.size(); ++i) u[i] = 0.7 + Vec3(0.3, -1.1, 0.5).dot(bodies.X[i]);
  return u;
}

}  // namespace

TEST(MortarBasis, RelativeDisplacementsOfRigidAndOfLinearFieldsVanishOnFlatInterfaces) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      const Scene s = stacked(d, quadratic, 4, 3, 0.3, 0.35);
      const Mortar mortar = s.mortar();
      const Matrix& G = mortar.relative();
      EXPECT_LT((G * Vector::Ones(G.cols())).lpNorm<Eigen::Infinity>(), 1e-14);
      EXPECT_LT((G * linear(s.bodies)).lpNorm<Eigen::Infinity>(), 1e-14);
    }
}

TEST(MortarBasis, RowsOfTKeepTranslationsAndLinearFieldsWhereContactNodesRestInW) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      const Scene s = stacked(d, quadratic, 4, 3, 0.3, 0.35);
      const Mortar mortar = s.mortar();
      const Matrix T = mortar.change_of_basis();
      for (const Vector& u : {Vector(Vector::Ones(s.bodies.nodes())), linear(s.bodies)}) {
        Vector w = u;
        if (quadratic)  // slave mid-edges: what they stand above the mean of their ends
          for (const Facet& f : s.pairs[0].slave.facets)
            for (int k = 0; k < edges_of_facet(d); ++k) w[f.node[d + k]] = 0;
        for (const SlaveNode& node : mortar.nodes()) w[node.node] = 0;
        EXPECT_LT((T * w - u).lpNorm<Eigen::Infinity>(), 1e-13);
      }
    }
}

TEST(MortarBasis, TInvertsTheDefinitionOfWWithTheIdentityAtHeldNodes) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      Scene s = stacked(d, quadratic, 4, 3, 0.3, 0.35);
      for (Index i = 0; i < s.bodies.nodes(); ++i)
        if (std::abs(s.bodies.X[i][0]) < 1e-9) s.hold(i, 0, 0);  // one side, its normal only
      const Mortar mortar = s.mortar();
      EXPECT_EQ(mortar.statistics().removed, 0);
      for (int c : {0, 1}) {
        std::vector<char> held(s.held.size());
        for (std::size_t i = 0; i < held.size(); ++i) held[i] = s.held[i] >> c & 1;
        const Vector w = Vector::Random(s.bodies.nodes());
        const Vector u = mortar.change_of_basis(held) * w;
        const Vector relative = mortar.relative() * u;
        std::vector<char> checked(held.size(), 0);
        for (std::size_t k = 0; k < mortar.nodes().size(); ++k) {
          const Index i = mortar.nodes()[k].node;
          if (held[i]) continue;
          EXPECT_NEAR(relative[Index(k)], w[i], 1e-13);
          checked[i] = 1;
        }
        for (const Facet& f : s.pairs[0].slave.facets)
          for (int k = 0; quadratic && k < edges_of_facet(d); ++k) {
            const auto [a, b] = edge_ends(d, k);
            const Index e = f.node[d + k];
            if (held[e] || checked[e]) continue;
            EXPECT_NEAR(u[e] - (u[f.node[a]] + u[f.node[b]]) / 2, w[e], 1e-14);
            checked[e] = 1;
          }
        for (std::size_t i = 0; i < held.size(); ++i)
          if (!checked[i]) {
            EXPECT_EQ(u[Index(i)], w[Index(i)]);
          }
      }
    }
}

TEST(MortarBasis, TheInverseOfTGivesWBackWithTheIdentityAtHeldNodes) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (bool side_held : {false, true}) {
        const Scene s = stacked(d, quadratic, 4, 3, 0.3, 0.35);
        std::vector<char> held;
        for (const Vec3& x : s.bodies.X) held.push_back(side_held && std::abs(x[0]) < 1e-9);
        EXPECT_LT(error_of_inverse(s.mortar(), held), 1e-13) << d << "D P" << 1 + quadratic;
      }
}

TEST(MortarBasis, OnMatchingMeshesTheRelativeDisplacementIsTheDifference) {
  for (int d : {2, 3}) {
    const Scene s = stacked(d, false, 4, 4, 0);
    const Mortar mortar = s.mortar();
    EXPECT_EQ(mortar.relative().nonZeros(), 2 * mortar.statistics().facing);
    EXPECT_EQ(mortar.statistics().partly_covered, 0);
  }
}

TEST(MortarBasis, ForcesBalanceOnCurvedSurfacesToo) {
  const auto bend = [](const Vec3& x) {
    return Vec3(x[0], x[1], x[2] + 0.2 * std::sin(2 * x[0]) * (1 + x[1]));
  };
  for (bool quadratic : {false, true}) {
    Scene s = stacked(3, quadratic, 4, 3, 0.2, 0.35);
    for (Vec3& x : s.bodies.X) x = bend(x);
    const Mortar mortar = s.mortar();
    const Vector f = mortar.relative().transpose() * Vector::Random(mortar.relative().rows());
    EXPECT_LT(std::abs(f.sum()), 1e-14 * f.lpNorm<1>());
  }
}

TEST(MortarBasis, ThreeBodiesInARowAreTwoPairs) {
  // the middle body is master of one pair and slave of the other, on its two faces
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      Scene s(d, quadratic);
      const int up = d - 1;
      std::array<Index, 4> first{};
      for (int body = 0; body < 3; ++body) {
        first[body] = static_cast<Index>(s.bodies.elements.size());
        s.bodies.add_box({3 + body, 3 + body, 2}, [&](const Vec3& x) {
          return Vec3(distorted(d, x, 0.2, body) + body * Vec3::Unit(up));
        });
      }
      first[3] = static_cast<Index>(s.bodies.elements.size());
      const auto face = [&](int body, Real z, long label) {
        const auto where = [&](const Vec3& x) { return std::abs(x[up] - z) < 1e-9; };
        return Surface{
            quadratic, {label}, s.bodies.boundary(where, label, first[body], first[body + 1])};
      };
      s.pairs = {{face(0, 1, 1), face(1, 1, 2)}, {face(1, 2, 3), face(2, 2, 4)}};
      s.start();
      hold_linear(s, some_gradient(d), [&](const Vec3& x) {
        for (int c = 0; c < d; ++c)
          if (std::abs(x[c]) < 1e-9 || std::abs(x[c] - (c == up ? 3 : 1)) < 1e-9) return true;
        return false;
      });
      const Mortar mortar = s.mortar();
      EXPECT_EQ(mortar.nodes().front().pair, 0);
      EXPECT_EQ(mortar.nodes().back().pair, 1);
      EXPECT_LT(error_of(s, solve_tied(s, mortar).u, some_gradient(d)), 1e-11);
    }
}
