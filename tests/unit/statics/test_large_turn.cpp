// Rotations that small rotations cannot mean, of bodies that are hardly strained.
#include <gtest/gtest.h>

#include "core/solver.h"
#include "core/statics/nearest_motion.h"
#include "../random_scene.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// A plate (2D) or a bar (3D) around `centre`, of body `number`, its dofs from the first on.
std::vector<NodePlace> bar(int d, Real size, const Eigen::Vector3d& centre, Index number,
                           Index first) {
  std::vector<NodePlace> nodes;
  for (int i = -2; i <= 2; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = d == 2 ? 0 : -1; k <= (d == 2 ? 0 : 1); ++k) {
        NodePlace n;
        Eigen::Map<Eigen::Vector3d>(n.x.data()) = centre + size * Eigen::Vector3d(i, j, k);
        for (int c = 0; c < d; ++c) n.dof[c] = first++;
        n.body = number;
        nodes.push_back(n);
      }
  return nodes;
}

/// a + w x (x - centre) + strain (x - centre) at the nodes.
Vector field(const std::vector<NodePlace>& nodes, int d, const Eigen::Vector3d& centre,
             const Eigen::Vector3d& a, const Eigen::Vector3d& w, Real strain, Index size) {
  Vector u = Vector::Zero(size);
  for (const NodePlace& n : nodes) {
    const Eigen::Vector3d arm = position(n) - centre;
    const Eigen::Vector3d v = a + w.cross(arm) + strain * arm;
    for (int c = 0; c < d; ++c) u[n.dof[c]] = v[c];
  }
  return u;
}

Index dofs_of(const std::vector<NodePlace>& nodes, int d) {
  return d * static_cast<Index>(nodes.size());
}

}  // namespace

TEST(LargeTurn, IsARotationBeyondSmallOnesOfABodyThatIsHardlyStrained) {
  const Eigen::Vector3d centre(3, -1, 0), none = Eigen::Vector3d::Zero();
  for (int d : {2, 3})
    for (Real size : {1e-6, 1.0, 1e6}) {
      const auto nodes = bar(d, size, centre, 0, 0);
      const auto turned = [&](Real turn, Real strain, const Eigen::Vector3d& a) {
        const auto turns = large_turns(
            nodes, d,
            field(nodes, d, centre, a, turn * Eigen::Vector3d::UnitZ(), strain, dofs_of(nodes, d)));
        return turns.empty() ? "no" : turns[0].large ? "large" : "as a jam";
      };
      EXPECT_STREQ(turned(2.9e-4, 0, none), "no");
      EXPECT_STREQ(turned(3.1e-4, 0, none), "as a jam");
      EXPECT_STREQ(turned(0.028, 0, none), "as a jam");
      EXPECT_STREQ(turned(0.032, 0, none), "large");
      EXPECT_STREQ(turned(-0.032, 0, none), "large");
      EXPECT_STREQ(turned(0.11, 0.11 / 2.9, none), "no");
      EXPECT_STREQ(turned(0.11, 0.11 / 7, none), "as a jam");
      EXPECT_STREQ(turned(0.11, 0.11 / 9, none), "large");
      EXPECT_STREQ(turned(500, 500 / 7., none), "as a jam");  // whatever the unit of the load
      EXPECT_STREQ(turned(500, 500 / 9., none), "large");
      EXPECT_STREQ(turned(0, 0, Eigen::Vector3d(1e9 * size, 0, 0)), "no");
      EXPECT_STREQ(turned(0.2, 0, Eigen::Vector3d(10 * size, 0, 0)), "large");
    }
}

TEST(LargeTurn, IsOfTheBodyThatTurnsAndNamesIt) {
  auto nodes = bar(2, 1, Eigen::Vector3d::Zero(), 0, 0);
  const auto second = bar(2, 1, Eigen::Vector3d(0, 10, 0), 1, dofs_of(nodes, 2));
  const Vector u = field(second, 2, Eigen::Vector3d(1, 10, 0), Eigen::Vector3d::Zero(),
                         Eigen::Vector3d(0, 0, -0.5), 0, 2 * dofs_of(nodes, 2));
  nodes.insert(nodes.end(), second.begin(), second.end());
  const auto turns = large_turns(nodes, 2, u);
  ASSERT_EQ(turns.size(), 1u);
  EXPECT_EQ(turns[0].body, 1);
  EXPECT_EQ(describe(turns[0], 2)
                .find("the body around (0, 10) has turned by 0.5 radians, a "
                      "rotation, clockwise, about (1, 10), and is strained by"),
            0u)
      << describe(turns[0], 2);
}

/// A round body of radius 2 that has turned, on two neighbouring vertices, of which the second
/// bears part of a weight of 1.
Real stands_on_edge(Real turn, Real facet, Real part, Real mu) {
  RigidMotion m;
  m.c = Vec3(5, 7, 0);
  m.w = Vec3(0, 0, turn);
  StandOnEdge edge;
  const Vec3 up = Vec3(0, 1, 0), aside = Vec3(std::sin(facet), std::cos(facet), 0);
  edge.add(m, m.c - 2 * up, up, 1 - part, mu * (1 - part));
  edge.add(m, m.c - 2 * aside, up, part, mu * part);
  edge.sum(AssembledSystem());
  return edge.share();
}

TEST(StandOnEdge, IsTheLesserOfWhatPressuresHoldAndOfWhatTheTurnTakesFromThat) {
  const Real facet = 0.1, held = 0.4 * std::sin(facet), round = 0.6 + 0.4 * std::cos(facet);
  for (Real mu : {0.1, 0.3}) {
    const Real arms = mu * (0.6 + 0.4), most = held + arms;
    EXPECT_NEAR(stands_on_edge(0.01, facet, 0.4, mu), 0.01 * round / most, 1e-12);
    EXPECT_NEAR(stands_on_edge(-0.01, facet, 0.4, mu), 0.01 * round / most, 1e-12);
    EXPECT_NEAR(stands_on_edge(0.05, facet, 0.4, mu), held / most, 1e-12);
    EXPECT_EQ(stands_on_edge(0.05, facet, 0, mu), 0);  // it rolls freely
  }
  EXPECT_EQ(stands_on_edge(0.02, facet, 0.4, 0), 0);
  EXPECT_EQ(stands_on_edge(0.05, 0.8, 0.5, 0.1), 0);  // on a face: it is no round body
  EXPECT_GT(stands_on_edge(0.05, 0.4, 0.5, 0.1), 0);
  EXPECT_EQ(StandOnEdge().share(), 0);
}

TEST(StandOnEdge, PressuresTurnWithTheNormalsOfAHub) {
  // an oval that its hub holds, told by n nodes all round; each is alone where they are few
  const auto held = [](int n) {
    RigidMotion m;
    m.c = Vec3(5, 7, 0);
    m.w = Vec3(0, 0, 0.02);
    StandOnEdge edge;
    for (int k = 0; k < n; ++k) {
      const Real t = 2 * M_PI * k / n, at = t + 0.06 * std::sin(2 * t);
      edge.add(m, m.c + 2 * Vec3(std::cos(t), std::sin(t), 0), Vec3(std::cos(at), std::sin(at), 0),
               1 + 0.9 * std::sin(2 * t), 0.02);
    }
    edge.sum(AssembledSystem());
    return edge.share();
  };
  EXPECT_LT(held(24), 0.01);
  EXPECT_GT(held(6), 0.15);
}

TEST(LargeTurn, AFieldSmallerThanTheLeastGyrationAllowsTurnsNothing) {
  for (int d : {2, 3}) {
    const Eigen::Vector3d centre(3, -1, 0);
    const auto nodes = bar(d, 0.5, centre, 0, 0);
    const Real gyration = least_gyration(nodes, d);
    for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 1)}) {
      if (d == 2 && axis[2] == 0) continue;
      const Vector u =
          field(nodes, d, centre, Eigen::Vector3d::Zero(), 0.1 * axis, 0, dofs_of(nodes, d));
      EXPECT_GE(largest_displacement(nodes, d, u), 0.1 * gyration);
    }
    // a bar turns about itself with the least
    EXPECT_NEAR(gyration, 0.5 * (d == 2 ? std::sqrt(2 + 2 / 3.) : std::sqrt(4 / 3.)), 1e-12);
  }
}

TEST(LargeTurn, OnlyABodyThatIsFreeToTurnAboutTheAxisMayRunAway) {
  const Eigen::Vector3d centre(3, -1, 0), none = Eigen::Vector3d::Zero();
  const auto nodes = bar(3, 1, centre, 0, 0);
  const Index n = dofs_of(nodes, 3);
  const auto about = [&](const Eigen::Vector3d& axis) {
    return field(nodes, 3, centre, none, axis, 0, n);
  };
  const Vector along = field(nodes, 3, centre, {1, 2, 3}, none, 0, n);
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ(), x = Eigen::Vector3d::UnitX();
  EXPECT_EQ(turning({}, nodes, 3, z).cols(), 0);
  EXPECT_EQ(turning({along}, nodes, 3, z).cols(), 0);
  EXPECT_EQ(turning({along, about(x)}, nodes, 3, z).cols(), 0);
  EXPECT_GT(turning({along, about(x + 1e-3 * z), about(x - 1e-3 * z)}, nodes, 3, z).cols(), 0);
  EXPECT_GT(turning({along, Vector(along + about(z))}, nodes, 3, z).cols(), 0);
  // what rounding leaves of other axes makes none of an axis that leans a little
  const Vector rounded = about(z + 1e-13 * x);
  EXPECT_LT(turning({about(z), rounded, along}, nodes, 3, (z + 1e-4 * x).normalized()).norm(), 10);
}

TEST(LargeTurn, ATranslationThatRoundingTurnsLeavesNoTurnFree) {
  const Eigen::Vector3d centre(3, -1, 0), axis = Eigen::Vector3d::UnitZ();
  for (int d : {2, 3}) {
    const auto nodes = bar(d, 1, centre, 0, 0);
    const auto moved = [&](Real w) {
      return field(nodes, d, centre, {1, 2, 0}, w * axis, 0, dofs_of(nodes, d));
    };
    EXPECT_EQ(turning({moved(1e-10)}, nodes, d, axis).cols(), 0);
    EXPECT_GT(turning({moved(1e-3)}, nodes, d, axis).cols(), 0);
  }
}

TEST(LargeTurn, ATurnComesFirstAndWhatGoesAlongTurnsNothing) {
  const Eigen::Vector3d centre(3, -1, 0), axis = Eigen::Vector3d::UnitZ();
  const auto nodes = bar(3, 1, centre, 0, 0);
  const Index n = dofs_of(nodes, 3);
  std::vector<Vector> motions;
  for (const Eigen::Vector3d& w : {Eigen::Vector3d(1, 0, 2), Eigen::Vector3d(0, 0, 0),
                                   Eigen::Vector3d(-1, 0, 1), Eigen::Vector3d(1, 1, 1)})
    motions.push_back(field(nodes, 3, centre, {1, 2, 0}, w, 0, n));
  const DenseMatrix by = turning(motions, nodes, 3, axis);
  ASSERT_EQ(by.cols(), 2);
  for (Index c = 0; c < 2; ++c) {
    Vector u = Vector::Zero(n);
    for (std::size_t k = 0; k < motions.size(); ++k) u += by(static_cast<Index>(k), c) * motions[k];
    EXPECT_LT((nearest_rigid_motion(nodes, 3, u).w - (c == 0 ? 1 : 0) * axis).norm(), 1e-12);
    EXPECT_GT(u.norm(), 0.1);
  }
}

namespace {

/// What stands against a turn about 0 in the plane, with translations along: closed nodes at x with
/// normals n, which stick or not.
StandAgainst against(const std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>& x_and_n,
                     bool stick) {
  StandAgainst contact(3);
  for (const auto& [x, n] : x_and_n) {
    const Eigen::Vector3d way = Eigen::Vector3d::UnitZ().cross(x);
    const Eigen::Vector3d t(-n[1], n[0], 0);
    contact.add(Eigen::Vector3d(n.dot(way), n[0], n[1]));
    if (stick) contact.add(Eigen::Vector3d(t.dot(way), t[0], t[1]));
    contact.add_way(way);
  }
  return contact;
}

}  // namespace

TEST(LargeTurn, NormalsThatLeanStandAgainstATurn) {
  for (Real lean : {0.05, 0.25}) {
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> nodes;
    for (int k = 0; k < 20; ++k) {
      const Real at = 0.1 * M_PI * k;
      nodes.push_back(
          {{std::cos(at), std::sin(at), 0}, {std::cos(at + lean), std::sin(at + lean), 0}});
    }
    EXPECT_EQ(against(nodes, false).holds(0.3), lean > 0.1);
    EXPECT_EQ(against(nodes, false).holds(3), lean > 0.1);
  }
}

TEST(LargeTurn, AContactHoldsATurnByItsWidthWhetherItSticksOrNot) {
  const Eigen::Vector3d down(0, -1, 0), up(0, 1, 0);
  for (bool stick : {false, true})
    for (Real half : {0.05, 0.1, 0.3}) {  // below the middle, over an arm of 1
      const StandAgainst floor = against({{{-half, -1, 0}, down}, {{half, -1, 0}, down}}, stick);
      for (Real turn : {0.11, 0.18, 0.35, 2.0})
        EXPECT_EQ(floor.holds(turn), half > std::min(turn / 2, 0.2)) << half << " " << turn;
    }
  // between two plates a roller turns where it slides, and not where it sticks
  EXPECT_FALSE(against({{{0, -1, 0}, down}, {{0, 1, 0}, up}}, false).holds(0.2));
  EXPECT_TRUE(against({{{0, -1, 0}, down}, {{0, 1, 0}, up}}, true).holds(2));
  // one point holds nothing unless nothing goes along, as on an axle
  EXPECT_FALSE(against({{{0, -1, 0}, down}}, true).holds(0.2));
  StandAgainst wheel(1);
  wheel.add(Vector::Constant(1, 0));
  wheel.add_way(Eigen::Vector3d::UnitX());
  EXPECT_FALSE(wheel.holds(0.2));
  wheel.add(Vector::Constant(1, 1));
  EXPECT_TRUE(wheel.holds(2));
  EXPECT_FALSE(StandAgainst(3).holds(0.2)) << "nothing touches";
}

TEST(LargeTurn, NoRandomSceneHasOne) {
  Index judged = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    const Recipe recipe = random_recipe(seed);
    if (recipe.algebraic) continue;
    const Scene s = make_scene(recipe);
    const Posed posed = s.system();
    const Solution a = solve(posed.problem(), Settings());
    if (a.status != Status::converged) continue;
    std::vector<NodePlace> nodes(s.n / s.d);
    const auto moved = [&](Index node, int c, int mode) { return s.modes(s.d * node + c, mode); };
    for (Index p = 0; p < s.n / s.d; ++p) {
      // from the rotations: e_z x X = (-y, x), and e_x x X = (0, -z, y)
      nodes[p].x = {moved(p, 1, s.d == 2 ? 2 : 5), -moved(p, 0, s.d == 2 ? 2 : 5),
                    s.d == 2 ? 0 : -moved(p, 1, 3)};
      for (int c = 0; c < s.d; ++c) nodes[p].dof[c] = s.d * p + c;
    }
    ++judged;
    for (const LargeTurn& turn : large_turns(nodes, s.d, posed.to_global(a.x)))
      EXPECT_FALSE(turn.large) << recipe;
  }
  EXPECT_GT(judged, 100);
}
