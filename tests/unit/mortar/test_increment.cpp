// What chooses is decided once per increment: a geometry that moves by rounding has the gaps and
// weights of before, at every threshold. Each scene stands at one, and jumps without that.
#include <gtest/gtest.h>

#include "surfaces.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

constexpr Real little = 1e-12;

/// The largest change of a gap, or of a row of G; 1 where other nodes have laws.
Real change(const Mortar& a, const Mortar& b) {
  if (a.nodes().size() != b.nodes().size()) return 1;
  Real most = DenseMatrix(a.relative() - b.relative()).cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < a.nodes().size(); ++k)
    most = std::max({most, std::abs(a.nodes()[k].gap - b.nodes()[k].gap),
                     (a.nodes()[k].normal - b.nodes()[k].normal).norm()});
  return most;
}

/// scene(t) on both sides of a threshold at t = 0: as each is by itself, and with what is decided
/// on one side, `hold`, kept on the other.
template <class Scene, class Hold>
void expect_continuous(const Scene& scene, const Hold& hold) {
  const Surfaces below = scene(-little), above = scene(little);
  EXPECT_GT(change(below.mortar(), above.mortar()), 1e-4);
  for (const Surfaces* from : {&below, &above})
    for (const Surfaces* at : {&below, &above}) {
      Surfaces begun = *from, kept = *at;
      hold(*from, begun);
      hold(*from, kept);
      EXPECT_LT(change(begun.mortar(), kept.mortar()), 1e-9);
    }
}

std::function<Vec3(const Vec3&)> lifted(int d, Real z, Real from, Real to) {
  return [=](const Vec3& x) {
    Vec3 y = x;
    y[0] = from + (to - from) * y[0];
    y[d - 1] = z;
    return y;
  };
}

void hold_facing(const Surfaces& from, Surfaces& kept) { kept.nodes.before = from.nodes.X; }
void hold_edges(const Surfaces& from, Surfaces& kept) { kept.nodes.reference = from.nodes.X; }

}  // namespace

TEST(MortarIncrement, ASurfaceStaysOnItsSideOfAStep) {
  for (int d : {2, 3}) {
    const Real size = (d == 2 ? 1 : std::sqrt(2)) / 6;  // of the slave's facets
    for (Real edge : {0.5, 0.53})                       // between facets, and within one
      expect_continuous(
          [&](Real t) {
            Surfaces s(d);
            s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0, edge), 1);
            for (const Facet& f : s.sheet(4, 1, lifted(d, -0.02 * size - t, edge, 1), 1).facets)
              s.pairs[0].master.facets.push_back(f);
            s.pairs[0].slave = s.sheet(6, -1, lifted(d, 0, 0, 1), 2);
            return s;
          },
          hold_facing);
  }
}

TEST(MortarIncrement, WhatMaxgapLeavesOutStaysOut) {
  for (int d : {2, 3})
    expect_continuous(
        [&](Real t) {
          Surfaces s(d);
          s.options.maxgap = 0.1;
          s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0, 0.5), 1);
          for (const Facet& f : s.sheet(4, 1, lifted(d, -0.1 - t, 0.5, 1), 1).facets)
            s.pairs[0].master.facets.push_back(f);
          s.pairs[0].slave = s.sheet(6, -1, lifted(d, 0, 0, 1), 2);
          return s;
        },
        hold_facing);
}

TEST(MortarIncrement, AnEdgeOfABodyStaysOne) {
  for (int d : {2, 3})
    expect_continuous(
        [&](Real t) {
          Surfaces s(d);
          const Real angle = std::acos(0.7) + t;  // smooth_side.h
          s.pairs[0].slave = s.sheet(
              4, -1,
              [=](const Vec3& x) {
                Vec3 y = x;
                const Real beyond = std::max<Real>(0, x[0] - 0.5);
                y[0] = std::min<Real>(x[0], 0.5) + beyond * std::cos(angle);
                y[d - 1] = 0.1 + beyond * std::sin(angle);
                return y;
              },
              2);
          s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0, 1), 1);
          return s;
        },
        hold_edges);
}

TEST(MortarIncrement, TheLargerOfTwoPatchesStaysTheOneThatOwnsTheirNode) {
  expect_continuous(
      [&](Real t) {
        Surfaces s(2);
        s.pairs[0].slave = s.sheet(
            8, -1,
            [=](const Vec3& x) {
              const Real along = x[0] > 0.5 ? (x[0] - 0.5) * (1 + t) : x[0] - 0.5;
              return Vec3(along, 0.1 + std::abs(along), 0);
            },
            2);
        s.pairs[0].master = s.sheet(5, 1, lifted(2, 0, -2, 2), 1);
        return s;
      },
      hold_facing);
}

TEST(MortarIncrement, ANormalThatIsHeldStaysSo) {
  for (int d : {2, 3})
    expect_continuous(
        [&](Real t) {
          Surfaces s(d);
          const Real slope = std::tan(std::asin(0.02)) + t;  // ownership.cpp
          s.pairs[0].slave = s.sheet(
              4, -1,
              [=](const Vec3& x) {
                Vec3 y = x;
                y[d - 1] = 0.1 + slope * x[0];
                return y;
              },
              2);
          s.nodes.held.assign(s.nodes.X.size(), 0);
          s.nodes.held[2] = 1;
          s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0, 1), 1);
          s.nodes.held.resize(s.nodes.X.size(), 0);
          return s;
        },
        hold_facing);
}

namespace {

/// The first facet of a slave, covered by so much of it.
Surfaces barely_covered(int d, Real fraction) {
  Surfaces s(d);
  const Real share = d == 2 ? fraction : 1 - std::sqrt(1 - fraction);
  s.pairs[0].slave = s.sheet(4, -1, lifted(d, 0.1, 0, 1), 2);
  s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0.25 * (1 - share), 1), 1);
  for (Index i : {0, 1, 2}) s.nodes.X[i][d - 1] += 0.01 * Real(i * i);
  return s;
}

/// The largest change of a gap, or of a row of G, of nodes that have laws in both: one that nothing
/// but a sliver covers enters with a weight that grows from zero.
Real change_of_common(const Mortar& a, const Mortar& b) {
  Real most = 0;
  for (std::size_t k = 0, l = 0; k < a.nodes().size(); ++k) {
    while (l < b.nodes().size() && b.nodes()[l].node < a.nodes()[k].node) ++l;
    if (l == b.nodes().size() || b.nodes()[l].node != a.nodes()[k].node) return 1;
    most = std::max({most, std::abs(a.nodes()[k].gap - b.nodes()[l].gap),
                     DenseMatrix(a.relative().row(Index(k)) - b.relative().row(Index(l)))
                         .cwiseAbs()
                         .maxCoeff()});
  }
  return most;
}

}  // namespace

TEST(MortarIncrement, WhatIsBarelyCoveredPassesToAllOfItsVerticesWithoutAJump) {
  for (int d : {2, 3})
    for (Real threshold : {1e-3, 2e-3}) {
      const Mortar below = barely_covered(d, threshold * (1 - 1e-9)).mortar(),
                   above = barely_covered(d, threshold * (1 + 1e-9)).mortar(),
                   beyond = barely_covered(d, threshold * 1.2).mortar();
      EXPECT_LT(change_of_common(below, above), 1e-9) << d << " " << threshold;
      EXPECT_GT(change_of_common(below, beyond), 1e-6) << d << " " << threshold;
    }
}

TEST(MortarIncrement, BodiesThatTurnFarKeepWhatTheyFace) {
  const Surfaces start = [] {
    Surfaces s(3);
    s.pairs[0].master = s.sheet(5, 1, lifted(3, 0, 0, 0.53), 1);
    for (const Facet& f : s.sheet(4, 1, lifted(3, -0.1, 0.53, 1), 1).facets)
      s.pairs[0].master.facets.push_back(f);
    s.pairs[0].slave = s.sheet(6, -1, lifted(3, 0, 0, 1), 2);
    return s;
  }();
  const Eigen::Matrix3d Q =
      (Eigen::AngleAxisd(2.5, Vec3(1, 2, 0).normalized()) * Eigen::AngleAxisd(1, Vec3::UnitZ()))
          .toRotationMatrix();
  Surfaces turned = start;
  for (Vec3& x : turned.nodes.X) x = Q * x;
  for (Pair& pair : turned.pairs)
    for (Surface* surface : {&pair.slave, &pair.master})
      for (Facet& f : surface->facets) f.outward = Q * f.outward;
  turned.nodes.before = turned.nodes.reference = start.nodes.X;
  const Mortar a = start.mortar(), b = turned.mortar();
  ASSERT_EQ(a.nodes().size(), b.nodes().size());
  EXPECT_LT(DenseMatrix(a.relative() - b.relative()).cwiseAbs().maxCoeff(), 1e-12);
  for (std::size_t k = 0; k < a.nodes().size(); ++k) {
    EXPECT_NEAR(a.nodes()[k].gap, b.nodes()[k].gap, 1e-13);
    EXPECT_LT((Q * a.nodes()[k].normal - b.nodes()[k].normal).norm(), 1e-12);
  }
  EXPECT_EQ(a.statistics().beyond_steps, b.statistics().beyond_steps);
  EXPECT_GT(a.statistics().beyond_steps, 0);
}
