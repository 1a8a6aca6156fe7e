#include <gtest/gtest.h>

#include "surfaces.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

using Map = std::function<Vec3(const Vec3&)>;
using Place = std::function<bool(const Vec3&)>;

/// The greatest error of the gap between two meshes of one smooth surface of n and 4n/3 cells, over
/// the nodes whose place on the sheet `where` accepts.
Real gap_noise(int d, const Map& shape, int n, bool smooth, bool quadratic, const Place& where) {
  Surfaces s(d, quadratic);
  std::vector<Vec3> place;
  const auto noted = [&](const Vec3& x) {
    place.push_back(x);
    return shape(x);
  };
  s.options.smooth = smooth;
  s.pairs[0].slave = s.sheet(n, 1, noted, 2);
  // mid-edges of the slave have no place of their own; they come before the master's vertices
  place.resize(s.nodes.X.size(), Vec3::Constant(-1));
  s.pairs[0].master = s.sheet(4 * n / 3, -1, noted, 1);
  Real error = 0;
  const Mortar mortar = s.mortar();
  for (const SlaveNode& node : mortar.nodes())
    if (where(place[node.node])) error = std::max(error, std::abs(node.gap));
  return error;
}

bool everywhere(const Vec3&) { return true; }

Vec3 arc(const Vec3& x) {
  const Real t = 1.2 * (x[0] - 0.5) + 0.2 * x[0] * x[0];
  return Vec3(std::sin(t), std::cos(t), 0);
}

Vec3 cap(const Vec3& x) {  // of the unit sphere
  return Vec3(0.8 * x[0] - 0.4 + 0.1 * x[1] * x[1], 0.8 * x[1] - 0.4, 1).normalized();
}

Vec3 wave(const Vec3& x) {
  return Vec3(x[0], x[1], 0.1 * std::sin(3 * x[0]) * std::cos(2 * x[1]) + 0.2 * x[1] * x[1]);
}

Real order(Real coarse, Real fine) { return std::log2(coarse / fine) / 2; }

}  // namespace

TEST(MortarGap, BetweenMeshesOfOneSmoothSurfaceItVanishesLikeTheFourthPowerOfTheMeshWidth) {
  const auto inner = [](const Vec3& x) {
    return x.head<2>().minCoeff() > 0.2 && x.head<2>().maxCoeff() < 0.8;
  };
  for (bool quadratic : {false, true}) {
    const auto at = [&](int d, const Map& shape, int n, bool smooth, const Place& where) {
      return gap_noise(d, shape, n, smooth, quadratic, where);
    };
    EXPECT_GT(order(at(2, arc, 12, true, everywhere), at(2, arc, 48, true, everywhere)), 3.8);
    EXPECT_LT(at(2, arc, 48, true, everywhere), 1e-8);
    EXPECT_GT(order(at(3, cap, 9, true, everywhere), at(3, cap, 36, true, everywhere)), 3.8);
    EXPECT_GT(order(at(3, wave, 9, true, inner), at(3, wave, 36, true, inner)), 3.8);
    // at the rim of a surface of changing curvature one order less
    EXPECT_GT(order(at(3, wave, 9, true, everywhere), at(3, wave, 36, true, everywhere)), 2.8);
    // without smoothing: the sagitta
    EXPECT_NEAR(order(at(2, arc, 12, false, everywhere), at(2, arc, 48, false, everywhere)), 2,
                0.1);
    EXPECT_NEAR(order(at(3, cap, 9, false, inner), at(3, cap, 36, false, inner)), 2, 0.1);
  }
}

TEST(MortarGap, OnCoarseMeshesOfQuicklyVaryingCurvatureNoJumpOfItIsSeen) {
  const auto inner = [](const Vec3& x) { return x[0] > 0.2 && x[0] < 0.8; };
  const auto both = [](const Vec3& x) {
    return x.head<2>().minCoeff() > 0.2 && x.head<2>().maxCoeff() < 0.8;
  };
  const auto ellipse = [](const Vec3& x) {
    const Real t = M_PI * (0.9 - 0.8 * x[0]);
    return Vec3(2 * std::cos(t), std::sin(t), 0);
  };
  const auto at = [&](int n) { return gap_noise(2, ellipse, n, true, false, inner); };
  EXPECT_LT(at(6), 1.5e-3);  // one-sided normals: four times, and twice of the next
  EXPECT_LT(at(12), 1.1e-4);
  const auto free_form = [](const Vec3& x) {
    const Real u = x[0], v = x[1];
    return Vec3(u, v, 0.2 * std::sin(3 * u) * std::cos(2 * v) + u * v * v / 4);
  };
  EXPECT_LT(gap_noise(3, free_form, 12, true, false, both), 5e-5);  // one-sided: 1.3e-4
  EXPECT_LT(gap_noise(3, free_form, 24, true, false, both), 4e-6);  // 1.4e-5
}

TEST(MortarGap, AlongTheNormalOfTheSlaveBetweenParallelPlanes) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (Real lift : {0.25, 0.0, -0.05}) {  // a little overlap is a negative gap
        Surfaces s(d, quadratic);
        s.pairs[0].slave = s.sheet(7, -1, lifted(d, lift), 2);
        s.pairs[0].master = s.sheet(5, 1, same, 1);
        const Mortar mortar = s.mortar();
        Real area = 0;
        for (const SlaveNode& node : mortar.nodes()) {
          EXPECT_NEAR(node.gap, lift, 1e-15);
          EXPECT_NEAR(node.distance, lift, 1e-15);
          EXPECT_LT((node.normal + Vec3::Unit(d - 1)).norm(), 1e-15);
          EXPECT_EQ(node.label, 2);
          area += node.weight;
        }
        EXPECT_NEAR(area, 1, 1e-14);
        EXPECT_NEAR(mortar.statistics().least_gap, lift, 1e-15);
        EXPECT_NEAR(mortar.statistics().largest_gap, lift, 1e-15);
      }
}

TEST(MortarGap, AtTheMiddleOfAnEdgeItIsExactForPlanesWhereTheFacetIsPartlyCoveredToo) {
  for (int d : {2, 3}) {
    Surfaces s(d, true);
    const int up = d - 1;
    const auto tilted = [up](const Vec3& x) {
      return Vec3(x + (0.1 + 0.3 * x[0]) * Vec3::Unit(up));
    };
    const auto smaller = [](const Vec3& x) { return Vec3(0.16 + 0.48 * x[0], 0.45 * x[1], 0); };
    s.pairs[0].slave = s.sheet(5, -1, tilted, 2);
    s.pairs[0].master = s.sheet(4, 1, smaller, 1);
    const Mortar mortar = s.mortar();
    EXPECT_GT(mortar.statistics().partly_covered, 0);
    const std::size_t edges = s.middle.size();
    EXPECT_LT(mortar.edges().size(), edges);
    EXPECT_GT(mortar.edges().size(), 1u);
    const Real along_normal = std::sqrt(1 + 0.3 * 0.3);
    for (const MidEdge& e : mortar.edges()) {
      EXPECT_LT((s.nodes.X[e.node] - (s.nodes.X[e.a] + s.nodes.X[e.b]) / 2).norm(), 1e-15);
      EXPECT_NEAR(e.distance, s.nodes.X[e.node][up] * along_normal, 1e-13);
    }
  }
}

TEST(MortarGap, AtTheMiddleOfAnEdgeWithoutLawsItIsThatOfWhatFacesIt) {
  Surfaces s(2, true);
  s.pairs[0].slave = s.sheet(4, -1, lifted(2, 0.25), 2);
  s.pairs[0].master = s.sheet(3, 1, same, 1);
  s.nodes.held.assign(s.nodes.X.size(), 0);
  s.nodes.held[0] = 2;  // an end of the slave
  const Mortar mortar = s.mortar();
  EXPECT_EQ(mortar.statistics().removed, 1);
  EXPECT_EQ(mortar.edges().size(), 4u);
  for (const MidEdge& e : mortar.edges()) EXPECT_NEAR(e.distance, 0.25, 1e-15);
}

TEST(MortarGap, AcrossAStepOfTheMasterItIsTheWeightedMean) {
  // gap x^2 between a flat slave and a master below: the mean of the quadratic interpolant
  Surfaces s(2);
  s.options.smooth = false;
  s.pairs[0].slave = s.sheet(4, -1, same, 2);
  s.pairs[0].master = s.sheet(
      64, 1, [](const Vec3& x) { return Vec3(x[0], -x[0] * x[0], 0); }, 1);
  const Mortar mortar = s.mortar();
  for (const SlaveNode& node : mortar.nodes()) {
    const Real x = s.nodes.X[node.node][0], h = 0.25;
    if (x < 0.1 || x > 0.9) continue;
    // int psi_i x^2 / D_i = x_i^2 - h^2/6 for inner nodes of an even mesh
    EXPECT_NEAR(node.gap, x * x - h * h / 6, 3e-4);
  }
}

TEST(MortarGap, AGapGivenAtTheNodesIsWeightedLikeTheDisplacement) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      Surfaces s(d, quadratic);
      s.pairs[0].slave = s.sheet(5, -1, same, 2);
      s.pairs[0].master = s.sheet(3, 1, same, 1);
      s.nodes.held.assign(s.nodes.X.size(), 0);
      s.nodes.held[0] = 7;  // a removed node: its neighbours carry its share
      const Mortar mortar = s.mortar();
      std::vector<NodeGap> gap;
      for (Index i = 0; i < Index(s.nodes.X.size()); ++i)
        gap.push_back({i, 2, 1 + 2 * s.nodes.X[i][0] - s.nodes.X[i][1]});
      const Vector weighted = mortar.weighted(gap);
      Real sum = 0, exact = d == 2 ? 2 : 1.5;
      for (std::size_t k = 0; k < mortar.nodes().size(); ++k)
        sum += mortar.nodes()[k].weight * weighted[Index(k)];
      EXPECT_NEAR(sum, exact, 1e-13);  // int gap, whoever carries it
      EXPECT_EQ(mortar.statistics().removed, 1);
    }
}

TEST(MortarGap, AcrossSharpEdgesNothingIsRounded) {
  // both bodies have the roof y = -|x - 1/2|: flat facets, whatever the vertex normals
  for (int d : {2, 3}) {
    Surfaces s(d);
    const auto roof = [d](const Vec3& x) {
      return Vec3(x - 2 * std::abs(x[0] - 0.5) * Vec3::Unit(d - 1));
    };
    s.pairs[0].slave = s.sheet(4, -1, roof, 2);
    s.pairs[0].master = s.sheet(6, 1, roof, 1);
    const Mortar mortar = s.mortar();
    for (const SlaveNode& node : mortar.nodes()) EXPECT_NEAR(node.gap, 0, 1e-15);
  }
}

TEST(MortarGap, AKinkBetweenStraightFlanksIsNotRounded) {
  for (Real slope : {-0.35, -0.2, -0.1, 0.1, 0.2, 0.35}) {  // two flanks that fit exactly
    const auto roof = [=](const Vec3& x) { return Vec3(x[0], -slope * std::abs(x[0] - 0.5), 0); };
    for (bool quadratic : {false, true})
      EXPECT_LT(gap_noise(2, roof, 6, true, quadratic, everywhere), 1e-14) << slope;
  }
}

TEST(MortarGap, AKinkBetweenFlanksThatBendALittleIsNotRoundedEither) {
  // flanks of radius 10 meet at 16 and at 28 degrees, which the facets beside turn by a fraction of
  for (Real slope : {0.14, 0.25}) {
    const auto roof = [=](const Vec3& x) {
      const Real a = std::abs(x[0] - 0.5);
      return Vec3(x[0], -slope * a - a * a / 20, 0);
    };
    EXPECT_LT(gap_noise(2, roof, 12, true, false, everywhere), 2e-6) << slope;
  }
}

TEST(MortarGap, FlanksOfTwoLabelsThatMeetAtAnAngleAreNotRounded) {
  for (int d : {2, 3}) {
    Surfaces s(d);
    const auto roof = [d](const Vec3& x) {
      Vec3 y = x;
      y[d - 1] = -0.2 * std::abs(x[0] - 0.5);
      return y;
    };
    s.pairs[0].slave = s.sheet(6, 1, roof, 2);
    s.pairs[0].master = s.sheet(8, -1, roof, 1);
    for (Surface* side : {&s.pairs[0].slave, &s.pairs[0].master}) {
      side->labels.push_back(side->labels[0] + 10);
      for (Facet& f : side->facets) {
        Real x = 0;
        for (int v = 0; v < d; ++v) x += s.nodes.X[f.node[v]][0] / d;
        if (x > 0.5) f.label += 10;
      }
    }
    const Mortar mortar = s.mortar();
    for (const SlaveNode& node : mortar.nodes()) EXPECT_LT(std::abs(node.gap), 1e-14) << d;
  }
}
