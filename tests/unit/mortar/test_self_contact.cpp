// A surface that touches itself: two thin arms of one body, whose four sides have one label.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "../refusal.h"
#include "core/assembly/mortar/self_contact.h"
#include "surfaces.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

constexpr Real thickness = 0.05;  // of an arm: less than a facet is long
constexpr Real opening = 0.2;

/// The sides of the arms from below; `closed`: by so much the upper arm has come down.
Surfaces arms(int d, Real closed, int finer = 0) {
  Surfaces s(d);
  const Real heights[] = {0, thickness, thickness + opening, 2 * thickness + opening};
  Surface all;
  for (int side = 0; side < 4; ++side) {
    const int cells = side == 2 ? 6 + finer : 6;
    for (Facet f : s.sheet(cells, side % 2 ? 1 : -1, lifted(d, heights[side]), 1).facets) {
      f.thickness = thickness;
      all.facets.push_back(f);
    }
  }
  all.labels = {1};
  s.pairs[0].slave = s.pairs[0].master = all;
  s.nodes.reference = s.nodes.X;
  for (Vec3& x : s.nodes.X)
    if (x[d - 1] > thickness + opening / 2) x[d - 1] -= closed;
  return s;
}

Surfaces rotated(Surfaces s, Real angle) {
  const Vec3 axis = s.nodes.dimension == 2 ? Vec3(0, 0, 1) : Vec3(1, 2, -1).normalized();
  turn(Eigen::AngleAxisd(angle, axis).toRotationMatrix(), s);
  return s;
}

/// The same with nodes and facets in the opposite order.
Surfaces renumbered(Surfaces s) {
  const Index n = static_cast<Index>(s.nodes.X.size());
  for (auto* X : {&s.nodes.X, &s.nodes.reference}) std::reverse(X->begin(), X->end());
  for (Surface* surface : {&s.pairs[0].slave, &s.pairs[0].master}) {
    std::reverse(surface->facets.begin(), surface->facets.end());
    for (Facet& f : surface->facets)
      for (Index& i : f.node) i = i < 0 ? i : n - 1 - i;
  }
  return s;
}

/// Contact nodes lie on one side alone, with the gap of the opening.
void expect_opening(const Surfaces& s, Real height, Real gap) {
  const int d = s.nodes.dimension;
  const Mortar mortar = s.mortar();
  EXPECT_GE(mortar.nodes().size(), d == 2 ? 7u : 49u);
  for (const SlaveNode& node : mortar.nodes()) {
    EXPECT_NEAR(s.nodes.reference[node.node][d - 1], height, 1e-12);
    EXPECT_NEAR(node.gap, gap, 1e-12);
  }
}

}  // namespace

TEST(MortarSelfContact, FacesAcrossTheOpeningAndNotThroughTheBody) {
  for (int d : {2, 3})
    for (Real closed : {0.0, 0.15, opening, opening + 0.01})
      for (bool otherwise : {false, true}) {
        const Surfaces s = arms(d, closed);
        expect_opening(otherwise ? renumbered(s) : s, thickness, opening - closed);
      }
}

TEST(MortarSelfContact, ItsSidesAreFoundAsFarApartAsMaxgap) {
  for (int d : {2, 3}) {
    Surfaces s = arms(d, 0);
    s.options.maxgap = 1.2 * opening;
    expect_opening(s, thickness, opening);
  }
}

TEST(MortarSelfContact, TheFinerSideIsTheSlave) {
  for (int d : {2, 3}) {
    expect_opening(arms(d, 0.1, 3), thickness + opening, opening - 0.1);
    expect_opening(renumbered(arms(d, 0.1, 3)), thickness + opening, opening - 0.1);
  }
}

TEST(MortarSelfContact, TheSlaveStaysTheSlaveHoweverTheBodyTurns) {
  for (int d : {2, 3})
    for (Real angle : {0.8, 2.0, 3.1, 4.5})
      expect_opening(rotated(arms(d, 0.1), angle), thickness, opening - 0.1);
}

namespace {

/// An arm of `length` above one of length 1, which comes last, and nothing else.
Surfaces two_arms(int d, Real length, int cells) {
  Surfaces s(d);
  Surface all = s.sheet(cells, -1, lifted(d, opening, 0, length), 1);
  append(all, s.sheet(6, 1, lifted(d, 0), 1));
  s.pairs[0].slave = s.pairs[0].master = all;
  return s;
}

}  // namespace

TEST(MortarSelfContact, TheSlaveStaysTheSlaveHoweverItIsStretched) {
  for (int d : {2, 3}) {
    Surfaces s = two_arms(d, 1, 6);
    s.nodes.reference = s.nodes.X;
    for (Vec3& x : s.nodes.X)
      if (x[d - 1] > 0) x[0] *= 0.9;
    const Mortar mortar = s.mortar();
    EXPECT_GT(mortar.nodes().size(), 5u);
    for (const SlaveNode& node : mortar.nodes()) EXPECT_EQ(s.nodes.X[node.node][d - 1], 0);
  }
}

TEST(MortarSelfContact, WhereTheSlaveEndsBeyondTheMasterItsLastNodeKeepsItsLaw) {
  for (int d : {2, 3}) {
    const Surfaces s = two_arms(d, 1.5, 12);
    const Mortar mortar = s.mortar();
    Index along = 0;
    for (const SlaveNode& node : mortar.nodes()) {
      EXPECT_EQ(s.nodes.X[node.node][d - 1], opening);
      along += d == 2 || s.nodes.X[node.node][1] == 0;
    }
    EXPECT_EQ(along, 9) << d;
  }
}

namespace {

/// A boundary through points, in 2D; its body lies to the right of the way along it.
Surfaces along(const std::vector<Vec3>& points) {
  Surfaces s(2);
  Surface& all = s.pairs[0].slave;
  all.labels = {1};
  s.nodes.X = points;
  for (Index i = 0; i + 1 < static_cast<Index>(points.size()); ++i) {
    s.add(all, {i, i + 1}, 1, 1);
    const Vec3 way = points[i + 1] - points[i];
    all.facets.back().outward = Vec3(-way[1], way[0], 0);
  }
  s.pairs[0].master = all;
  return s;
}

/// Places of the contact nodes.
std::vector<Vec3> touching(const Surfaces& s) {
  std::vector<Vec3> places;
  const Mortar mortar = s.mortar();
  for (const SlaveNode& node : mortar.nodes()) places.push_back(s.nodes.X[node.node]);
  std::sort(places.begin(), places.end(), [](const Vec3& a, const Vec3& b) {
    return std::tie(a[0], a[1]) < std::tie(b[0], b[1]);
  });
  return places;
}

}  // namespace

TEST(MortarSelfContact, AFoldIsPartedAtItsRoot) {
  std::vector<Vec3> notch;
  for (int k = -3; k <= 3; ++k) notch.push_back(Vec3(0.1 * k, std::abs(k), 0));
  for (const Surfaces& s : {along(notch), renumbered(along(notch))}) {
    const std::vector<Vec3> places = touching(s);
    ASSERT_EQ(places.size(), 3u);  // not the root, which is on both sides
    for (const Vec3& x : places) EXPECT_GT(x[0] * places[0][0], 0);
  }
}

TEST(MortarSelfContact, TheEndOfASlotIsOfTheMasterHoweverItIsNumbered) {
  std::vector<Vec3> slot;
  for (int k = 3; k >= 0; --k) slot.push_back(Vec3(k, 0.6, 0));
  for (int k = 0; k <= 3; ++k) slot.push_back(Vec3(k, -0.4, 0));
  const Surfaces s = along(slot);
  const std::vector<Vec3> places = touching(s), again = touching(renumbered(s));
  EXPECT_EQ(places.size(), 3u);
  EXPECT_EQ(places, again);
}

TEST(MortarSelfContact, ABodyThatHasTurnedFarKeepsItsSides) {
  for (int d : {2, 3}) {
    Surfaces s = arms(d, 0.1);
    s.nodes.before = s.nodes.X;
    expect_opening(rotated(s, 3), thickness, opening - 0.1);
  }
}

TEST(MortarSelfContact, TheSlaveIsTheSameHoweverTheSceneIsTurned) {
  for (int d : {2, 3}) {
    // arms of equal facets, of which the one is longer; in 3D they lean, too
    Surfaces s = two_arms(d, 1.5, 9);
    for (Vec3& x : s.nodes.X)
      if (d == 3) x[1] += 0.3 * x[0] * x[0] + 0.4 * x[0] * x[2];
    const auto slaves = [](const Surfaces& scene) {
      std::set<Index> nodes;
      const Mortar mortar = scene.mortar();
      for (const SlaveNode& node : mortar.nodes()) nodes.insert(node.node);
      return nodes;
    };
    const std::set<Index> expected = slaves(s);
    for (Real angle : {0.3, 0.8, 1.6, 2.4, 3.1, 3.9, 4.7, 5.5}) {
      const Surfaces now = rotated(s, angle);
      EXPECT_EQ(slaves(now), expected) << d << "D " << angle;
      const Index last = static_cast<Index>(s.nodes.X.size()) - 1;
      std::set<Index> renamed;
      for (Index i : slaves(renumbered(now))) renamed.insert(last - i);
      EXPECT_EQ(renamed, expected) << d << "D " << angle << " renumbered";
    }
  }
}

TEST(MortarSelfContact, OfArmsThatAreAlikeTheRightHandTellsTheSlave) {
  Surfaces s = two_arms(2, 1, 6);
  const auto wall = [](const Vec3& x) { return Vec3(1.5, opening / 2 + x[0] - 0.5, 0); };
  for (Facet f : s.sheet(5, 1, wall, 1).facets) {
    f.outward = Vec3::UnitX();
    for (Surface* surface : {&s.pairs[0].slave, &s.pairs[0].master}) surface->facets.push_back(f);
  }
  std::set<bool> upper;
  for (Real angle : {0.3, 0.8, 1.6, 2.4, 3.1, 3.9, 4.7, 5.5}) {
    const Mortar mortar = rotated(s, angle).mortar();
    for (const SlaveNode& node : mortar.nodes())
      upper.insert(s.nodes.X[node.node][1] > opening / 2);
  }
  EXPECT_EQ(upper.size(), 1u);
}

TEST(MortarSelfContact, FacetsThatAreHardlySmallerMakeNoSlave) {
  for (int d : {2, 3}) {
    std::set<Real> heights;
    for (Real scale : {0.95, 1.05}) {
      Surfaces s = two_arms(d, 1, 6);
      for (Vec3& x : s.nodes.X)
        if (x[d - 1] > 0)
          for (int c = 0; c + 1 < d; ++c) x[c] *= scale;
      for (const Facet& f : s.sheet(3, 1, lifted(d, 0, 3, 5), 1).facets)  // it tells the axes
        for (Surface* surface : {&s.pairs[0].slave, &s.pairs[0].master})
          surface->facets.push_back(f);
      const Mortar mortar = s.mortar();
      EXPECT_GT(mortar.nodes().size(), 5u);
      for (const SlaveNode& node : mortar.nodes()) heights.insert(s.nodes.X[node.node][d - 1]);
    }
    EXPECT_EQ(heights.size(), 1u) << d;
  }
}

TEST(MortarSelfContact, WhatFacesItselfNowAloneTouchesNow) {
  Surfaces s = two_arms(2, 1, 12);
  s.nodes.reference = s.nodes.before = s.nodes.X;
  for (Vec3& x : s.nodes.before)
    if (x[1] > 0) x[0] += 10;
  EXPECT_EQ(s.mortar().nodes().size(), 13u);
}

TEST(MortarSelfContact, TwoBodiesThatUseOneLabelAreTwoBodies) {
  Surfaces s(2);
  s.pairs[0].slave = s.sheet(5, -1, lifted(2, 0.1), 3);
  s.pairs[0].master = s.sheet(5, 1, same, 3);
  const Mortar mortar = s.mortar();
  ASSERT_EQ(mortar.nodes().size(), 6u);
  for (const SlaveNode& node : mortar.nodes()) EXPECT_EQ(s.nodes.X[node.node][1], 0.1);
}

TEST(MortarSelfContact, AFlatFaceDoesNotFaceItself) {
  Surfaces s(2);
  s.pairs[0].slave = s.sheet(5, 1, same, 3);
  s.pairs[0].master = s.pairs[0].slave;
  const std::string text = frictioncg::test::refusal([&] { s.mortar(); });
  EXPECT_EQ(text.find("label 3 does not face itself"), 0u) << text;
}

namespace {

/// Sheets of one boundary, body by body: from, to, height, side and number of facets.
struct OfBody {
  Real from, to, height;
  int side, facets;
};

std::vector<Pair> parted_bodies(const std::vector<OfBody>& bodies) {
  Surfaces s(2);
  Surface& all = s.pairs[0].slave;
  Index body = 0;
  for (const OfBody& b : bodies) {
    for (Facet f : s.sheet(b.facets, b.side, lifted(2, b.height, b.from, b.to), 1).facets) {
      f.body = body;
      f.one_body = true;
      all.facets.push_back(f);
    }
    ++body;
  }
  s.pairs[0].master = all;
  std::vector<Roles> roles;
  find_roles(s.nodes, s.pairs, infinity, roles);
  return parted(s.pairs, roles, false);
}

}  // namespace

TEST(MortarSelfContact, OfSeveralBodiesEachIsTheSlaveOfTheCoarserThatItIsNearestTo) {
  // a floor under a coarse body and, further away, a fine one; one of its facets is before both
  const auto pairs =
      parted_bodies({{0, 1.25, 0, 1, 5}, {0, 0.6, 0.01, -1, 1}, {0.6, 1.2, 0.3, -1, 6}});
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].slave.facets.size(), 3u);
  EXPECT_EQ(pairs[0].slave.facets.front().body, 0);
  EXPECT_EQ(pairs[1].slave.facets.size(), 6u);
  EXPECT_EQ(pairs[1].slave.facets.front().body, 2);
  EXPECT_EQ(pairs[1].master.facets.size(), 2u);
  for (const Pair& pair : pairs) {
    EXPECT_TRUE(pair.itself);
    EXPECT_EQ(pair.given, 0);
    for (const Facet& f : pair.master.facets) EXPECT_FALSE(f.one_body);
  }
}

TEST(MortarSelfContact, WhatASlaveDoesNotSeeIsItsSlave) {
  // the flanks of a fine roof miss the coarse bar below that it comes first to
  Surfaces s(2);
  Surface& all = s.pairs[0].slave;
  for (Facet f : s.sheet(1, 1, lifted(2, 0, -0.5, 0.5), 1).facets) {
    f.body = 0;
    all.facets.push_back(f);
  }
  const auto flank = [](Real side) {
    return [side](const Vec3& x) { return Vec3(side * 0.6 * x[0], 0.3 + 2 * x[0], 0); };
  };
  for (Real side : {-1., 1.})
    for (Facet f : s.sheet(4, -1, flank(side), 1).facets) {
      f.body = 1;
      f.outward = Vec3(side, -0.3, 0);
      f.thickness = 0;  // its flanks are no partners
      all.facets.push_back(f);
    }
  s.pairs[0].master = all;
  EXPECT_GT(s.mortar().nodes().size(), 0u);
}

TEST(MortarSelfContact, AFacetOverTwoBodiesHasBothAsMasters) {
  const auto pairs =
      parted_bodies({{-0.5, 0.5, 0, 1, 1}, {0.5, 1.5, 0, 1, 1}, {0.1, 0.9, 0, -1, 1}});
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].slave.facets.front().body, 2);
  EXPECT_EQ(pairs[0].master.facets.size(), 2u);
}
