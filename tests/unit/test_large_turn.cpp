// Rotations that small rotations cannot mean, of bodies that are hardly strained.
#include <gtest/gtest.h>

#include "core/solver.h"
#include "freefem/large_turn.h"
#include "random_scene.h"

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

TEST(LargeTurn, IsARotationOfMoreThanATenthOfABodyThatIsHardlyStrained) {
  const Eigen::Vector3d centre(3, -1, 0), none = Eigen::Vector3d::Zero();
  for (int d : {2, 3})
    for (Real size : {1e-6, 1.0, 1e6}) {
      const auto nodes = bar(d, size, centre, 0, 0);
      const auto turned = [&](Real turn, Real strain, const Eigen::Vector3d& a) {
        return large_turns(nodes, d,
                           field(nodes, d, centre, a, turn * Eigen::Vector3d::UnitZ(), strain,
                                 dofs_of(nodes, d)))
            .size();
      };
      EXPECT_EQ(turned(0.09, 0, none), 0u);
      EXPECT_EQ(turned(0.11, 0, none), 1u);
      EXPECT_EQ(turned(-0.11, 0, none), 1u);
      EXPECT_EQ(turned(0.11, 0.11 / 25, none), 0u);
      EXPECT_EQ(turned(0.11, 0.11 / 35, none), 1u);
      EXPECT_EQ(turned(500, 500 / 25., none), 0u);  // other units
      EXPECT_EQ(turned(0, 0, Eigen::Vector3d(1e9 * size, 0, 0)), 0u);
      EXPECT_EQ(turned(0.2, 0, Eigen::Vector3d(10 * size, 0, 0)), 1u);
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
  EXPECT_FALSE(leave_free_to_turn({}, nodes, 3, z));
  EXPECT_FALSE(leave_free_to_turn({along}, nodes, 3, z));
  EXPECT_FALSE(leave_free_to_turn({along, about(x)}, nodes, 3, z));
  EXPECT_TRUE(leave_free_to_turn({along, about(x + 1e-3 * z), about(x - 1e-3 * z)}, nodes, 3, z));
  EXPECT_TRUE(leave_free_to_turn({along, Vector(along + about(z))}, nodes, 3, z));
}

TEST(LargeTurn, ATranslationThatRoundingTurnsLeavesNoTurnFree) {
  const Eigen::Vector3d centre(3, -1, 0), axis = Eigen::Vector3d::UnitZ();
  for (int d : {2, 3}) {
    const auto nodes = bar(d, 1, centre, 0, 0);
    const auto turning = [&](Real w) {
      return field(nodes, d, centre, {1, 2, 0}, w * axis, 0, dofs_of(nodes, d));
    };
    EXPECT_FALSE(leave_free_to_turn({turning(1e-10)}, nodes, d, axis));
    EXPECT_TRUE(leave_free_to_turn({turning(1e-3)}, nodes, d, axis));
  }
}

TEST(LargeTurn, NormalsThatLeanByMoreThanATenthStandAgainstATurn) {
  RigidMotion turn;
  turn.c = Eigen::Vector3d::Zero();
  turn.w = Eigen::Vector3d::UnitZ();
  for (Real lean : {0.05, 0.2}) {
    StandAgainst normals;
    for (int k = 0; k < 20; ++k) {
      const Real at = 0.1 * M_PI * k;
      normals.add({std::cos(at + lean), std::sin(at + lean), 0}, {std::cos(at), std::sin(at), 0},
                  turn);
    }
    EXPECT_EQ(normals.holds(), lean > 0.1);
  }
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
    EXPECT_TRUE(large_turns(nodes, s.d, posed.to_global(a.x)).empty()) << recipe;
  }
  EXPECT_GT(judged, 100);
}
