#include <gtest/gtest.h>

#include "../refusal.h"
#include "core/assembly/mortar/topology.h"
#include "surfaces.h"

using namespace frictioncg;
using namespace frictioncg::test;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

/// Slave (label 2) at height z above a master (label 1).
Surfaces above(int d, Real z, bool quadratic = false) {
  Surfaces s(d, quadratic);
  s.pairs[0].master = s.sheet(3, 1, same, 1);
  s.pairs[0].slave = s.sheet(4, -1, lifted(d, z), 2);
  return s;
}

std::string refusal(const Surfaces& s) {
  return frictioncg::test::refusal([&] { s.mortar(); });
}

}  // namespace

TEST(MortarRefuses, ALabelOnBothSides) {
  Surfaces s = above(2, 0);
  s.pairs[0].slave.facets.push_back(s.pairs[0].master.facets[1]);
  EXPECT_TRUE(names(refusal(s), "label 1 is on both sides")) << refusal(s);
  Surfaces twice = above(3, 0);
  twice.pairs.push_back(twice.pairs[0]);
  EXPECT_TRUE(names(refusal(twice), "label 2 is slave twice")) << refusal(twice);
}

TEST(MortarRefuses, AFacetThatIsSlaveOfOnePairAndMasterOfAnotherByPlace) {
  for (int d : {2, 3}) {
    // a plate between two: its upper face is the second one's slave, and the first one's master
    Surfaces s = above(d, 0);
    s.pairs.emplace_back();
    s.pairs[1].slave = s.pairs[0].master;
    s.pairs[1].master = s.sheet(5, -1, lifted(d, 0.2), 3);
    EXPECT_TRUE(names(refusal(s),
                      "on label 1 is slave of one pair (master: label 3) and master of "
                      "another (slave: label 2); exchange slave and master"))
        << refusal(s);
    std::swap(s.pairs[0].slave, s.pairs[0].master);
    EXPECT_TRUE(names(refusal(s), "label 1 is slave twice")) << refusal(s);
  }
}

TEST(MortarRefuses, SurfacesWithNothingBetweenThemAndNamesTheDistance) {
  for (int d : {2, 3}) {
    Surfaces s = above(d, 0.5);
    EXPECT_EQ(refusal(s), "");
    s.options.maxgap = 0.2;
    EXPECT_TRUE(names(refusal(s), "within maxgap = 0.2; the nearest opposite facet is 0.5 away"))
        << refusal(s);
    s.options.maxgap = 0.6;
    EXPECT_EQ(refusal(s), "");
    s.options.maxgap = 0;
    EXPECT_TRUE(names(refusal(s), "maxgap = 0; it must be > 0")) << refusal(s);
    s = above(d, 0.5);
    for (Facet& f : s.pairs[0].slave.facets) f.outward *= -1;  // looks away
    EXPECT_TRUE(names(refusal(s), "the surfaces are 0.5 apart")) << refusal(s);
  }
}

TEST(MortarRefuses, NodesThatMergedMeshesShare) {
  Surfaces s = above(2, 0.5);
  s.pairs[0].slave.facets[0].node[0] = 0;  // the master's first node
  s.options.element_groups = [](Index node) { return node == 0 ? 2 : 1; };
  EXPECT_TRUE(names(refusal(s), "share the node at (0, 0), where 2 bodies meet")) << refusal(s);
  s.options.element_groups = [](Index) { return 1; };
  EXPECT_EQ(refusal(s), "");
}

TEST(MortarRefuses, ASlaveHeldByDirichletConditionsEverywhere) {
  Surfaces s = above(3, 0);
  s.nodes.held.assign(s.nodes.X.size(), 0);
  for (const Facet& f : s.pairs[0].slave.facets)
    for (int v = 0; v < 3; ++v) s.nodes.held[f.node[v]] = 4;  // z
  EXPECT_TRUE(names(refusal(s), "hold the normal of every slave node (label 2); swap"))
      << refusal(s);
  for (unsigned char& bits : s.nodes.held) bits &= 3;  // x and y hold no normal
  EXPECT_EQ(refusal(s), "");
}

TEST(MortarRefuses, ASlaveOfWhichOnlyHeldNodesFaceSomethingUnlessBodiesMove) {
  Surfaces s = above(2, 0);
  for (const Facet& f : s.pairs[0].master.facets)
    for (int v = 0; v < 2; ++v) s.nodes.X[f.node[v]][0] *= 0.1;
  s.nodes.held.assign(s.nodes.X.size(), 0);
  const std::vector<Facet>& slave = s.pairs[0].slave.facets;
  for (Index i : {slave[0].node[0], slave[0].node[1]}) s.nodes.held[i] = 2;
  EXPECT_TRUE(names(refusal(s), "hold the normal of every slave node (label 2) that faces the"))
      << refusal(s);
  s.nodes.reference = s.nodes.X;
  EXPECT_EQ(refusal(s), "");
  EXPECT_TRUE(s.mortar().nodes().empty());
  for (const Facet& f : slave) s.nodes.held[f.node[0]] = s.nodes.held[f.node[1]] = 2;
  EXPECT_TRUE(names(refusal(s), "that faces the master; swap")) << refusal(s);
}

TEST(MortarRefuses, ASlaveThatIsHeldBeforeItsMasterAndEndsInANodeOfAnotherPair) {
  Surfaces s = above(2, 0);  // pair 0 has the left half of the slave, pair 1 the right one
  s.pairs.emplace_back();
  std::vector<Facet>&left = s.pairs[0].slave.facets, &right = s.pairs[1].slave.facets;
  right.assign(left.begin() + 2, left.end());
  left.resize(2);
  for (Facet& f : right) f.label = 4;
  s.pairs[1].slave.labels = {4};
  s.pairs[1].master = s.sheet(2, 1, lifted(2, 0, 0.8), 3);
  EXPECT_EQ(refusal(s), "");
  s.nodes.held.assign(s.nodes.X.size(), 0);
  for (int v : {0, 1}) s.nodes.held[right[1].node[v]] = 2;
  EXPECT_TRUE(names(refusal(s), "hold the normal of every slave node (label 4) that faces the"))
      << refusal(s);
}

TEST(MortarRefuses, AnOverlapDeeperThanAFacet) {
  for (int d : {2, 3}) {
    EXPECT_EQ(refusal(above(d, -0.3)), "");
    const std::string text = refusal(above(d, -0.9));
    EXPECT_TRUE(names(text, "slave and master overlap by 0.9 at")) << text;
    EXPECT_TRUE(names(text, "give maxgap below 0.9")) << text;
  }
}

TEST(MortarRefuses, FacetsWithoutExtent) {
  Surfaces s = above(2, 0);
  s.nodes.X[1] = s.nodes.X[0];
  EXPECT_TRUE(names(refusal(s), "a facet of label 1 at (0, 0, 0) has no extent")) << refusal(s);
}

TEST(MortarRefuses, GivenNormalsWithoutDirectionOrIntoTheSlaveWhereSomethingFacesIt) {
  for (int d : {2, 3}) {
    Surfaces s = above(d, 0.5);
    const Index first = s.pairs[0].slave.facets[0].node[0];
    s.options.normals.assign(s.nodes.X.size(), -5 * Vec3::Unit(d - 1));
    EXPECT_EQ(refusal(s), "");
    s.options.normals[first] = Vec3::Zero();
    EXPECT_TRUE(names(refusal(s), "normal has no direction at (0, ")) << refusal(s);
    EXPECT_TRUE(names(refusal(s), "on label 2; give the outward normal of the slave"));
    s.options.normals[first] = Vec3::Unit(d - 1);
    EXPECT_TRUE(names(refusal(s), "on label 2 points into the slave, whose boundary has"))
        << refusal(s);
    s.options.maxgap = 0.4;  // nothing faces the slave: another refusal
    EXPECT_TRUE(names(refusal(s), "within maxgap")) << refusal(s);
    s.options.normals[first] = -Vec3::Unit(d - 1) + 0.3 * Vec3::Unit(0);
    s.options.maxgap = 1;
    const Mortar mortar = s.mortar();
    EXPECT_LT((mortar.nodes()[0].normal - s.options.normals[first].normalized()).norm(), 1e-15);
  }
}

TEST(MortarTraps, TheFarSideOfAPlateIsNoOverlap) {
  // the whole boundary of a thick plate is master: its bottom faces what looks up above it
  Surfaces s = above(2, 0.1);
  append(s.pairs[0].master, s.sheet(5, -1, lifted(2, -2), 1));
  append(s.pairs[0].slave, s.sheet(5, 1, lifted(2, 1), 3));  // the top of the body above
  s.pairs[0].slave.labels = {2, 3};
  const Mortar mortar = s.mortar();
  for (const SlaveNode& node : mortar.nodes()) EXPECT_NEAR(node.gap, 0.1, 1e-15);
  EXPECT_EQ(mortar.statistics().facing, 5);
}

TEST(MortarTraps, AMasterThatIsMerelyBehindIsLeftOutByMaxgap) {
  Surfaces s = above(2, -0.9);
  s.options.maxgap = 0.5;
  EXPECT_TRUE(names(refusal(s), "within maxgap = 0.5")) << refusal(s);
}

TEST(MortarTraps, AFacetThatSlopesAwayIsWithinMaxgapByTheMiddleOfWhatItCovers) {
  for (int d : {2, 3}) {
    // at distances 0.4 .. 0.9; the middles of the triangles are at x = 1/3 and 2/3
    Surfaces s(d);
    const auto sloping = [d](const Vec3& x) {
      return Vec3(x - (0.4 + 0.5 * x[0]) * Vec3::Unit(d - 1));
    };
    s.pairs[0].master = s.sheet(1, 1, sloping, 1);
    s.pairs[0].slave = s.sheet(1, -1, same, 2);
    s.options.maxgap = 0.5;
    const std::string nearest = d == 2 ? "0.65 away" : "0.566667 away";
    EXPECT_TRUE(names(refusal(s), "within maxgap = 0.5; the nearest opposite facet is " + nearest))
        << refusal(s);
    s.options.maxgap = 0.7;  // in 3D one of the two triangles stays out
    EXPECT_EQ(s.mortar().statistics().facing, d == 2 ? 2 : 3);
  }
}

TEST(MortarTraps, AHeldNormalRemovesTheNodeAndALittleIsProjected) {
  for (const Real tilt : {0.0, 0.015, 0.1}) {
    Surfaces s(2);
    const auto tilted = [&](const Vec3& x) { return Vec3(x[0], tilt * x[0], 0); };
    s.pairs[0].master = s.sheet(3, 1, tilted, 1);
    s.pairs[0].slave = s.sheet(4, -1, tilted, 2);
    const Index last = static_cast<Index>(s.nodes.X.size()) - 1;
    s.nodes.held.assign(s.nodes.X.size(), 0);
    s.nodes.held[last] = 1;  // x held, as on a plane of symmetry
    const Mortar mortar = s.mortar();
    EXPECT_EQ(mortar.statistics().removed, tilt > 0.02 ? 1 : 0);
    EXPECT_EQ(mortar.statistics().held, tilt > 0.02 ? 1 : 0);
    EXPECT_EQ(mortar.statistics().first_held, tilt > 0.02 ? last : -1);
    for (const SlaveNode& node : mortar.nodes()) {
      const Vec3 free = Vec3(tilt, -1, 0).normalized();
      const Vec3 expected = node.node == last ? Vec3(0, -1, 0) : free;
      EXPECT_LT((node.normal - expected).norm(), 1e-15);
    }
  }
}

TEST(MortarTraps, TheEndsOfAHeldMidEdgeCarryNoLaw) {
  for (int d : {2, 3})
    for (int c = 0; c < d; ++c) {
      Surfaces s = above(d, 0, true);
      const Facet& f = s.pairs[0].slave.facets[1];
      const auto [a, b] = edge_ends(d, 0);
      s.nodes.held.assign(s.nodes.X.size(), 0);
      s.nodes.held[f.node[d]] = static_cast<unsigned char>(1 << c);
      const Mortar mortar = s.mortar();
      EXPECT_EQ(mortar.statistics().held, 2);
      for (const SlaveNode& node : mortar.nodes())
        EXPECT_TRUE(node.node != f.node[a] && node.node != f.node[b]) << d << c;
      std::vector<char> held(s.nodes.X.size(), 0);
      held[f.node[d]] = 1;
      EXPECT_NO_THROW(mortar.change_of_basis(held));
    }
}

TEST(MortarTraps, AFaceMayBeSlaveOnOnePartAndMasterOnAnother) {
  // of the plate 1, x < 1 is the slave of what stands there, x > 1 the master; where these parts
  // meet its nodes keep their law if their pair is the first
  const auto expect = [](int d, bool meet, bool plate_first) {
    Surfaces s(d);
    const Surface plate = s.sheet(6, 1, lifted(d, 0, 0, 2), 1);
    s.pairs = {{plate, s.sheet(4, -1, lifted(d, 0.1, 0, meet ? 1 : 0.6), 2)},
               {s.sheet(5, -1, lifted(d, 0.1, meet ? 1 : 1.4, 2), 3), plate}};
    if (!plate_first) std::swap(s.pairs[0], s.pairs[1]);
    const Index of_plate = plate_first ? 0 : 1, of_other = 1 - of_plate;
    const Mortar mortar = s.mortar();
    EXPECT_EQ(mortar.statistics(of_plate).removed, !meet || plate_first ? 0 : d == 2 ? 1 : 7);
    EXPECT_EQ(mortar.statistics(of_plate).held, 0);  // none by Dirichlet conditions
    EXPECT_EQ(mortar.statistics(of_other).removed, 0);
    EXPECT_EQ(mortar.statistics(of_other).facing, d == 2 ? 6 : 36);
    for (const SlaveNode& node : mortar.nodes()) {
      EXPECT_NEAR(node.distance, 0.1, 1e-14);
      EXPECT_EQ(node.label, node.pair == of_plate ? 1 : 3);
    }
    EXPECT_LT(error_of_inverse(mortar), 1e-13);
  };
  for (int d : {2, 3})
    for (const bool meet : {false, true})
      for (const bool plate_first : {false, true}) expect(d, meet, plate_first);
}

TEST(MortarTraps, LabelsThatMeetSmoothlyShareTheirNode) {
  Surfaces one = above(2, 0), two = above(2, 0);
  two.pairs[0].slave.labels = {5, 2};
  for (int f : {0, 1}) two.pairs[0].slave.facets[f].label = 5;
  const Mortar a = one.mortar(), b = two.mortar();
  EXPECT_LT(Matrix(a.relative() - b.relative()).norm(), 1e-15);
  EXPECT_EQ(b.nodes()[2].label, 5);  // the first listed
  EXPECT_EQ(b.nodes()[3].label, 2);
}

TEST(MortarTraps, WhereLabelsMeetAtAnAngleTheNodeIsOfTheFirstListed) {
  for (int d : {2, 3})
    for (const std::vector<long>& labels : {std::vector<long>{2, 3}, std::vector<long>{3, 2}}) {
      Surfaces s(d);  // both bodies have a roof, the slave's left flank is label 2
      const auto roof = [d](const Vec3& x) {
        return Vec3(x - std::abs(x[0] - 0.5) * Vec3::Unit(d - 1));
      };
      s.pairs[0].slave = s.sheet(4, -1, roof, 2);
      s.pairs[0].master = s.sheet(6, 1, roof, 1);
      s.pairs[0].slave.labels = labels;
      for (Facet& f : s.pairs[0].slave.facets)
        for (int v = 0; v < d; ++v)
          if (s.nodes.X[f.node[v]][0] > 0.6) f.label = 3;
      const Mortar mortar = s.mortar();
      Index at_ridge = 0;
      for (const SlaveNode& node : mortar.nodes()) {
        if (s.nodes.X[node.node][0] != 0.5) continue;
        ++at_ridge;
        EXPECT_EQ(node.label, labels[0]);
        const Vec3 flank = (labels[0] == 2 ? 1 : -1) * Vec3::Unit(0) - Vec3::Unit(d - 1);
        EXPECT_LT((node.normal - flank.normalized()).norm(), 1e-15);
      }
      EXPECT_EQ(at_ridge, d == 2 ? 1 : 5);
    }
}

TEST(MortarTraps, GroupsOfElementsAroundANode) {
  // a fan of triangles, whole or cut by a crack at 0, and two fans that share the node alone
  const std::vector<std::array<Index, 4>> cracked{{0, 1, 2, -1}, {0, 2, 3, -1}, {0, 3, 4, -1}};
  EXPECT_EQ(facet_connected_groups(2, cracked), 1);
  const std::vector<std::array<Index, 4>> merged{{0, 1, 2, -1}, {0, 2, 3, -1}, {0, 4, 5, -1}};
  EXPECT_EQ(facet_connected_groups(2, merged), 2);
  const std::vector<std::array<Index, 4>> by_an_edge{{0, 1, 2, 3}, {0, 1, 4, 5}};
  EXPECT_EQ(facet_connected_groups(3, by_an_edge), 2);
  const std::vector<std::array<Index, 4>> by_a_face{{0, 1, 2, 3}, {4, 2, 1, 0}};
  EXPECT_EQ(facet_connected_groups(3, by_a_face), 1);
}
