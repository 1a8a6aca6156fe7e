// A surface that touches itself: two thin arms of one body, whose four sides have one label.
#include <gtest/gtest.h>

#include <algorithm>

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
    const auto shape = [=](const Vec3& x) {
      Vec3 y = x;
      y[d - 1] = heights[side];
      return y;
    };
    const int cells = side == 2 ? 6 + finer : 6;
    for (const Facet& f : s.sheet(cells, side % 2 ? 1 : -1, shape, 1).facets)
      all.facets.push_back(f);
  }
  all.labels = {1};
  s.pairs[0].slave = s.pairs[0].master = all;
  s.nodes.reference = s.nodes.X;
  for (Vec3& x : s.nodes.X)
    if (x[d - 1] > thickness + opening / 2) x[d - 1] -= closed;
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
  for (const ContactNode& node : mortar.nodes()) {
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

TEST(MortarSelfContact, TheFinerSideIsTheSlave) {
  for (int d : {2, 3}) {
    expect_opening(arms(d, 0.1, 3), thickness + opening, opening - 0.1);
    expect_opening(renumbered(arms(d, 0.1, 3)), thickness + opening, opening - 0.1);
  }
}

TEST(MortarSelfContact, TheSlaveStaysTheSlaveHoweverTheBodyTurns) {
  for (int d : {2, 3})
    for (Real angle : {0.8, 2.0, 3.1, 4.5}) {
      Surfaces s = arms(d, 0.1);
      const Eigen::Matrix3d Q =
          Eigen::AngleAxisd(angle, d == 2 ? Vec3(0, 0, 1) : Vec3(1, 2, -1).normalized())
              .toRotationMatrix();
      for (Vec3& x : s.nodes.X) x = Q * x;
      for (Surface* surface : {&s.pairs[0].slave, &s.pairs[0].master})
        for (Facet& f : surface->facets) f.outward = Q * f.outward;
      expect_opening(s, thickness, opening - 0.1);
    }
}

namespace {

/// An arm of `length` above one of length 1, which comes last, and nothing else.
Surfaces two_arms(int d, Real length, int cells) {
  Surfaces s(d);
  Surface all = s.sheet(cells, -1, lifted(d, opening, 0, length), 1);
  for (const Facet& f : s.sheet(6, 1, lifted(d, 0), 1).facets) all.facets.push_back(f);
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
    for (const ContactNode& node : mortar.nodes()) EXPECT_EQ(s.nodes.X[node.node][d - 1], 0);
  }
}

TEST(MortarSelfContact, WhereTheSlaveEndsBeyondTheMasterItsLastNodeKeepsItsLaw) {
  for (int d : {2, 3}) {
    const Surfaces s = two_arms(d, 1.5, 12);
    const Mortar mortar = s.mortar();
    Index along = 0;
    for (const ContactNode& node : mortar.nodes()) {
      EXPECT_EQ(s.nodes.X[node.node][d - 1], opening);
      along += d == 2 || s.nodes.X[node.node][1] == 0;
    }
    EXPECT_EQ(along, 9) << d;
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
  s.pairs[0].slave = s.sheet(
      5, -1, [](const Vec3& x) { return Vec3(x[0], 0.1, 0); }, 3);
  s.pairs[0].master = s.sheet(
      5, 1, [](const Vec3& x) { return x; }, 3);
  const Mortar mortar = s.mortar();
  ASSERT_EQ(mortar.nodes().size(), 6u);
  for (const ContactNode& node : mortar.nodes()) EXPECT_EQ(s.nodes.X[node.node][1], 0.1);
}

TEST(MortarSelfContact, AFlatFaceDoesNotFaceItself) {
  Surfaces s(2);
  s.pairs[0].slave = s.sheet(
      5, 1, [](const Vec3& x) { return x; }, 3);
  s.pairs[0].master = s.pairs[0].slave;
  try {
    s.mortar();
    ADD_FAILURE();
  } catch (const IllegalInput& e) {
    EXPECT_NE(std::string(e.what()).find("label 3 does not face itself"), std::string::npos);
  }
}
