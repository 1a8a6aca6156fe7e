#include <gtest/gtest.h>

#include "core/assembly/mortar/search.h"
#include "core/assembly/mortar/topology.h"
#include "steps.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

/// Steps of the search per slave facet, for surfaces of about `cells` facets each way.
Real steps_per_facet(int d, int cells, Real height) {
  Surfaces s(d);
  const auto wave = [&](Real lift) {
    return [=](const Vec3& x) {
      Vec3 y = x;
      y[d - 1] = lift + 0.05 * std::sin(6 * x[0]) * std::cos(4 * x[1] * (d == 3));
      return y;
    };
  };
  s.pairs[0].master = s.sheet(cells, 1, wave(0), 1);
  s.pairs[0].slave = s.sheet(cells + cells / 3, -1, wave(height), 2);
  const Mortar mortar = s.mortar();
  return Real(mortar.statistics().visited) / Real(s.pairs[0].slave.facets.size());
}

}  // namespace

TEST(MortarSearch, StepsPerFacetGrowLikeTheLogarithm) {
  for (Real height : {0.0, 0.3}) {
    const Real few = steps_per_facet(2, 100, height), many = steps_per_facet(2, 10000, height);
    EXPECT_LT(many - few, 3 * std::log2(100.0));
    const Real few3 = steps_per_facet(3, 7, height), many3 = steps_per_facet(3, 70, height);
    EXPECT_LT(many3 - few3, 12 * std::log2(100.0));  // 9800 facets, of which those above are near
    EXPECT_LT(many3, 200);
  }
}

TEST(MortarSearch, FindsWhatAComparisonOfAllPairsFinds) {
  for (int d : {2, 3}) {
    Surfaces s(d);
    const auto bulge = [&](const Vec3& x) {
      Vec3 y = x;
      y[d - 1] += 0.8 * x[0] * (1 - x[0]);
      return y;
    };
    const Surface upper = s.sheet(5, -1, bulge, 2), lower = s.sheet(7, 1, bulge, 1);
    std::vector<Plane> planes, slaves;
    for (const Facet& f : lower.facets) planes.push_back(plane_of(d, f, s.nodes.X));
    for (const Facet& f : upper.facets) slaves.push_back(plane_of(d, f, s.nodes.X));
    const FacetTree tree(d, lower.facets, planes, s.nodes.X);
    std::vector<Index> found;
    for (const Plane& base : slaves) {
      tree.find({base, -1, 1, true}, found);
      for (std::size_t m = 0; m < planes.size(); ++m) {
        Eigen::Matrix2Xd xi(2, d);
        for (int v = 0; v < d; ++v)
          xi.col(v) = base.B * (s.nodes.X[lower.facets[m].node[v]] - base.origin);
        const Vec2 middle = xi.rowwise().mean();
        if (middle.minCoeff() < 0 || middle.sum() > 1) continue;  // surely overlaps the slave facet
        EXPECT_EQ(std::count(found.begin(), found.end(), Index(m)), 1);
      }
    }
    EXPECT_NEAR(tree.nearest(s.nodes.X[0] - 3 * Vec3::Unit(d - 1)), 3, 0.2);
  }
}

TEST(MortarSearch, WhereThreeFacetsMeetNoneGoesOnSmoothlyInAnother) {
  Surfaces s(2);
  s.nodes.X = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(1, 1, 0)};
  Surface branched;
  for (Index end : {0, 2, 3}) s.add(branched, {end, 1}, 1, 1);
  const Side side(2, branched, s.nodes.X);
  ASSERT_EQ(side.joints.size(), 2u);
  for (const Joint& joint : side.joints) EXPECT_EQ(joint.cosine, -1);
  Surface straight;
  for (Index end : {0, 2}) s.add(straight, {end, 1}, 1, 1);
  EXPECT_NEAR(Side(2, straight, s.nodes.X).joints.at(0).cosine, 1, 1e-15);
}

TEST(MortarSearch, TheNearestOfSeveralSurfacesIsThePartner) {
  // three sheets below the slave, of other meshes; the middle one reaches half way
  for (int d : {2, 3}) {
    Surfaces s(d);
    s.pairs[0].master = s.sheet(5, 1, lifted(d, 0), 1);
    const Index near = static_cast<Index>(s.nodes.X.size());
    append(s.pairs[0].master, s.sheet(4, 1, lifted(d, 0.3, 0, 0.5), 1));
    const Index away = static_cast<Index>(s.nodes.X.size());
    for (const Facet& f : s.sheet(3, -1, lifted(d, 0.4), 1).facets)  // faces the other way
      s.pairs[0].master.facets.push_back(f);
    s.pairs[0].slave = s.sheet(8, -1, lifted(d, 1), 2);
    const Mortar mortar = s.mortar();
    EXPECT_EQ(mortar.statistics().partly_covered, 0);
    for (const SlaveNode& node : mortar.nodes()) {
      const Real x = s.nodes.X[node.node][0];
      if (x > 0.37 && x < 0.63) continue;
      EXPECT_NEAR(node.gap, x < 0.5 ? 0.7 : 1, 1e-14);
    }
    Real on_near = 0, on_far = 0;
    const Vector weights = [&] {
      Vector D(mortar.nodes().size());
      for (std::size_t k = 0; k < mortar.nodes().size(); ++k)
        D[Index(k)] = mortar.nodes()[k].weight;
      return Vector(mortar.relative().transpose() * D);
    }();
    for (Index i = 0; i < near; ++i) on_far -= weights[i];
    for (Index i = near; i < away; ++i) on_near -= weights[i];
    EXPECT_NEAR(on_near, 0.5, 1e-13);
    EXPECT_NEAR(on_far, 0.5, 1e-13);  // that of the facet beyond the step, too
  }
}

TEST(MortarSearch, BesideAStepEachNodeHasTheGapOfOneSurface) {
  for (int d : {2, 3})
    for (auto [drop, height] :  // of the step, and of the slave over what is up
         std::vector<std::pair<Real, Real>>{{0.05, 0}, {0.5, 0}, {0.06, -0.03}}) {
      Surfaces s(d, false);
      s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0, 0.53), 1);
      append(s.pairs[0].master, s.sheet(4, 1, lifted(d, -drop, 0.53), 1));
      s.pairs[0].slave = s.sheet(6, -1, lifted(d, height), 2);
      const Mortar mortar = s.mortar();
      EXPECT_GT(mortar.statistics().partly_covered, 0);
      std::size_t near = 0, far = 0;
      for (const SlaveNode& node : mortar.nodes()) {
        near += std::abs(node.distance - height) < 1e-13;
        far += std::abs(node.distance - height - drop) < 1e-13;
      }
      EXPECT_GT(near, 0u);
      EXPECT_GT(far, 0u);
      EXPECT_EQ(near + far, mortar.nodes().size());
      EXPECT_FALSE(steps_of(s).empty());
    }
}

TEST(MortarSearch, ADentedMasterOfOneSheetHasNoStepsWhereverTheSlaveMoves) {
  // bent facets: their planes, continued to a vertex of the slave, differ by a part of its size
  const auto bowl = [](Real shift) {
    return [shift](const Vec3& x) {
      const Real a = x[0] - 0.5, b = x[1] - 0.5;
      return Vec3(x[0] + shift, x[1], 0.25 * (a * a + b * b));
    };
  };
  const auto dented = [](const Vec3& x) {
    return Vec3(3 * x[0] - 1, 2 * x[1] - 0.5, 0.02 * std::sin(40 * x[0]) * std::sin(23 * x[1]));
  };
  for (const int fineness : {11, 43}) {
    std::map<Index, Vec3> last;
    for (int k = 0; k < 25; ++k) {
      Surfaces s(3);
      s.pairs[0].slave = s.sheet(5, -1, bowl(0.008 * k), 2);
      s.pairs[0].master = s.sheet(fineness, 1, dented, 1);
      const Mortar mortar = s.mortar();
      EXPECT_TRUE(steps_of(s).empty());
      EXPECT_EQ(mortar.statistics().facing, 36);
      for (const SlaveNode& node : mortar.nodes()) {
        const auto [at, is_new] = last.emplace(node.node, node.gap * node.normal);
        if (!is_new) {
          EXPECT_LT((at->second - node.gap * node.normal).norm(), 0.016) << k;
        }
        at->second = node.gap * node.normal;
      }
    }
  }
}

TEST(MortarSearch, WhereTwoSurfacesOverlapByAHairTheNearerHidesTheOther) {
  for (int d : {2, 3})
    for (Real hair : {0.004, 1e-4, 1e-7}) {  // of a facet of length 1
      Surfaces s(d, false);
      s.pairs[0].master = s.sheet(1, 1, lifted(d, 0, 0, 0.5 + hair), 1);
      append(s.pairs[0].master, s.sheet(1, 1, lifted(d, -0.001, 0.5), 1));
      s.pairs[0].slave = s.sheet(1, -1, lifted(d, 0.1), 2);
      const Mortar mortar = s.mortar();
      Real covered = 0;
      for (const SlaveNode& node : mortar.nodes()) covered += node.weight;
      EXPECT_NEAR(covered, 1, 1e-13) << d << " " << hair;
    }
}

TEST(MortarSearch, SurfacesSideBySideWithoutAStepAreFacedBoth) {
  for (int d : {2, 3}) {
    Surfaces s(d, false);
    s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0, 0.53), 1);
    append(s.pairs[0].master, s.sheet(4, 1, lifted(d, 0, 0.53), 1));
    s.pairs[0].slave = s.sheet(6, -1, same, 2);
    const Mortar mortar = s.mortar();
    EXPECT_EQ(mortar.statistics().partly_covered, 0);
    for (const SlaveNode& node : mortar.nodes()) EXPECT_LT(std::abs(node.gap), 1e-13);
  }
}
