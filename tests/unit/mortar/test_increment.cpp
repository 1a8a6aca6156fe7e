// What chooses is decided once per increment: a geometry that moves by rounding has the gaps and
// weights of before, at every threshold. Each scene stands at one, and jumps without that.
#include <gtest/gtest.h>

#include "core/linear_algebra.h"
#include "steps.h"

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
/// on one side, `hold`, kept on the other: gaps and rows change by less than `bound`.
template <class Scene, class Hold>
void expect_continuous(const Scene& scene, const Hold& hold, Real bound = 1e-9) {
  const Surfaces below = scene(-little), above = scene(little);
  EXPECT_GT(change(below.mortar(), above.mortar()), 1e-4);
  for (const Surfaces* from : {&below, &above})
    for (const Surfaces* at : {&below, &above}) {
      Surfaces begun = *from, kept = *at;
      hold(*from, begun);
      hold(*from, kept);
      EXPECT_LT(change(begun.mortar(), kept.mortar()), bound);
      if (!begun.nodes.before.empty()) {  // where the increment began nothing is another
        EXPECT_EQ(change(begun.mortar(), from->mortar()), 0);
      }
    }
}

/// The slave over a sheet, and over one beyond half of it that is farther than maxgap by t.
Surfaces left_out(int d, Real t) {
  Surfaces s(d);
  s.options.maxgap = 0.1;
  s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0, 0.5), 1);
  append(s.pairs[0].master, s.sheet(4, 1, lifted(d, -0.1 - t, 0.5, 1), 1));
  s.pairs[0].slave = s.sheet(6, -1, lifted(d, 0, 0, 1), 2);
  return s;
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
            append(s.pairs[0].master, s.sheet(4, 1, lifted(d, -0.02 * size - t, edge, 1), 1));
            s.pairs[0].slave = s.sheet(6, -1, lifted(d, 0, 0, 1), 2);
            return s;
          },
          hold_facing);
  }
}

TEST(MortarIncrement, WhatMaxgapLeavesOutStaysOut) {
  for (int d : {2, 3}) expect_continuous([&](Real t) { return left_out(d, t); }, hold_facing);
}

TEST(MortarIncrement, WhatIsBeforeASlopeStaysWithinMaxgapAsItSlides) {
  // at 0 the middle of what is before the slope is as far from it as maxgap
  const auto over_a_slope = [](Real t) {
    Surfaces s(2);
    s.options.maxgap = 0.25;
    const auto slope = [](const Vec3& x) {
      const Real along = 0.1 + 0.5 * x[0];
      return Vec3(along, -0.5 * along, 0);
    };
    s.pairs[0].master = s.sheet(1, 1, slope, 1);
    append(s.pairs[0].master, s.sheet(1, 1, lifted(2, 0, 0.7, 1), 1));
    s.pairs[0].slave = s.sheet(2, -1, lifted(2, 0.1, t, 1 + t), 2);
    return s;
  };
  for (Real begun : {-0.02, 0.02})
    for (Real t : {-0.1, 0.1}) {
      Surfaces s = over_a_slope(t);
      s.nodes.before = over_a_slope(begun).nodes.X;
      EXPECT_EQ(s.mortar().nodes().size(), over_a_slope(begun).mortar().nodes().size()) << t;
    }
  EXPECT_NE(over_a_slope(0.02).mortar().nodes().size(),
            over_a_slope(-0.02).mortar().nodes().size());
}

TEST(MortarIncrement, MaxgapIsOfThePlacesNowWhereNothingWasBeforeAFacet) {
  for (int d : {2, 3}) {
    const auto over_a_slope = [d](Real from) {  // whose plane is far from where it has no facets
      Surfaces s(d);
      s.options.maxgap = 1;
      s.pairs[0].master = s.sheet(
          5, 1,
          [d](const Vec3& x) {
            Vec3 y = x;
            y[d - 1] = -1.7 * std::max<Real>(0, x[0] - 0.6);
            return y;
          },
          1);
      s.pairs[0].slave = s.sheet(4, -1, lifted(d, 0.1, from, from + 0.97), 2);
      return s;
    };
    Surfaces s = over_a_slope(0);
    const Mortar by_itself = s.mortar();
    s.nodes.before = over_a_slope(-1).nodes.X;
    EXPECT_EQ(change(s.mortar(), by_itself), 0) << d;
  }
}

TEST(MortarIncrement, StepsAreOfThePlacesNowWhereNothingWasBeforeAFacet) {
  for (int d : {2, 3}) {
    const auto over_a_joint = [d](Real from) {  // of two sheets, one of them a slope
      Surfaces s(d);
      const auto ramp = [d](const Vec3& x) {
        Vec3 y = x;
        y[0] = 0.5 + 0.5 * x[0];
        y[d - 1] = -0.15 * x[0];
        return y;
      };
      s.pairs[0].master = s.sheet(2, 1, lifted(d, 0, 0, 0.5), 1);
      append(s.pairs[0].master, s.sheet(2, 1, ramp, 1));
      s.pairs[0].slave = s.sheet(3, -1, lifted(d, 0.1, from, from + 0.97), 2);
      return s;
    };
    Surfaces s = over_a_joint(0);
    const Mortar by_itself = s.mortar();
    s.nodes.before = over_a_joint(-1).nodes.X;
    EXPECT_EQ(change(s.mortar(), by_itself), 0) << d;
  }
}

TEST(MortarIncrement, ASurfaceThatDoesNotFaceItselfLeavesOtherPairsWhatTheyDecided) {
  for (int d : {2, 3})
    expect_continuous(
        [&](Real t) {
          Surfaces s = left_out(d, t);
          s.pairs.resize(2);
          s.pairs[1].slave = s.pairs[1].master = s.sheet(2, 1, lifted(d, 5, 0, 1), 3);
          s.nodes.reference = s.nodes.X;
          return s;
        },
        hold_facing);
}

TEST(MortarIncrement, AnEdgeOfABodyStaysOne) {
  for (int d : {2, 3})
    expect_continuous(
        [&](Real t) {
          Surfaces s(d);
          const Real angle = std::acos(0.7) + t;  // topology.h
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

TEST(MortarIncrement, ANodeStaysWithThePatchThatOwnsIt) {
  for (int d : {2, 3})
    expect_continuous(
        [&](Real t) {
          Surfaces s(d);
          const auto corner = [d](Real x, Real along, Real z) {
            return d == 2 ? Vec3(x, z, 0) : Vec3(x, along, z);
          };
          Surface& slave = s.pairs[0].slave;
          slave = s.sheet(
              4, -1, [=](const Vec3& x) { return corner(x[0], x[1], 0); }, 3);  // its right end ...
          const Index ends = 4, row = 5, first = static_cast<Index>(s.nodes.X.size());
          for (Facet f : s.sheet(
                              4, 1, [=](const Vec3& x) { return corner(1, x[1], x[0]); }, 2)
                             .facets) {  // ... begins the side
            for (int v = 0; v < d; ++v)
              if ((f.node[v] - first) % row == 0) f.node[v] += ends - first;
            f.outward = Vec3::UnitX();
            slave.facets.push_back(f);
          }
          slave.labels = {2, 3};
          Surface& master = s.pairs[0].master;
          master = s.sheet(
              5, 1, [=](const Vec3& x) { return corner(2 * x[0] - 0.5, x[1], -0.1); }, 1);
          for (Facet f :
               s.sheet(
                    5, 1, [=](const Vec3& x) { return corner(1.1, x[1], 0.0025 - t + x[0]); }, 1)
                   .facets) {  // a wall, which begins so near to the corner that it reaches that
            f.outward = -Vec3::UnitX();
            master.facets.push_back(f);
          }
          return s;
        },
        hold_facing);
}

namespace {

/// A slave whose end, node 4, begins the master of the pair before it, and what comes to face that
/// from `above` its first facet on.
Surfaces crosswise(Real above) {
  Surfaces s(2);
  s.pairs.resize(2);
  s.pairs[1].slave = s.sheet(4, -1, lifted(2, 0.1), 3);
  s.pairs[1].master = s.sheet(5, 1, lifted(2, 0, -0.5, 1.5), 1);
  const Index first = static_cast<Index>(s.nodes.X.size());
  s.pairs[0].master = s.sheet(
      4, 1, [](const Vec3& x) { return Vec3(1, 0.1 + x[0], 0); }, 2);
  s.pairs[0].master.facets[0].node[0] = 4;
  s.pairs[0].slave = s.sheet(
      5, -1, [=](const Vec3& x) { return Vec3(1.1, 0.35 + above + x[0], 0); }, 4);
  for (Facet& f : s.pairs[0].master.facets) f.outward = Vec3::UnitX();
  for (Facet& f : s.pairs[0].slave.facets) f.outward = -Vec3::UnitX();
  s.nodes.X[first] = s.nodes.X[4];
  return s;
}

}  // namespace

TEST(MortarIncrement, ANodeThatLiesOnAMasterStaysRemovedOrKeepsItsLaw) {
  expect_continuous([](Real t) { return crosswise(-t); }, hold_facing);
}

TEST(MortarIncrement, WhatComesToFaceASlaveOfAnotherPairHasNoMasterThere) {
  for (bool reversed : {false, true}) {
    Surfaces s = crosswise(-0.1);
    for (Facet& f : s.pairs[0].master.facets)
      if (reversed) std::swap(f.node[0], f.node[1]);
    s.nodes.before = crosswise(0.1).nodes.X;
    const Mortar mortar = s.mortar();
    Index of_pair_0 = 0;
    for (const SlaveNode& node : mortar.nodes()) {
      const Real seen = mortar.relative().coeff(&node - mortar.nodes().data(), 4);
      EXPECT_EQ(seen != 0, node.pair == 1 && node.node == 4) << node.node;
      of_pair_0 += node.pair == 0;
    }
    EXPECT_EQ(of_pair_0, 6);
  }
}

TEST(MortarIncrement, ASlaveWaitsOnAPathForAsLongAsSomeNodeOfItMayCarryALaw) {
  for (int d : {2, 3}) {
    // half of the slave is covered, by nodes that are held
    const auto scene = [d](Index free) {
      Surfaces s(d);
      s.pairs[0].slave = s.sheet(4, -1, lifted(d, 0.1, 0, 1), 2);
      s.nodes.held.assign(s.nodes.X.size(), 7);
      if (free >= 0) s.nodes.held[free] = 0;
      s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0, 0.45), 1);
      s.nodes.held.resize(s.nodes.X.size(), 0);
      s.nodes.reference = s.nodes.X;
      return s;
    };
    const Index last =
        static_cast<Index>(scene(-1).pairs[0].slave.facets.back().node[d == 2 ? 1 : 2]);
    EXPECT_EQ(scene(4).mortar().nodes().size(), 0u) << d;  // a last vertex of facets
    EXPECT_EQ(scene(last).mortar().nodes().size(), 0u) << d;
    EXPECT_THROW(scene(-1).mortar(), IllegalInput) << d;
    Surfaces taken = scene(4);
    taken.nodes.taken.assign(taken.nodes.X.size(), 0);
    taken.nodes.taken[4] = 1;
    EXPECT_THROW(taken.mortar(), IllegalInput) << d << "by an obstacle";
    // what is covered lies on the master, too, and the rest is held
    Surfaces shared = scene(4);
    for (Index i = 0; i < static_cast<Index>(shared.nodes.X.size()); ++i)
      if (shared.nodes.X[i][0] < 0.6) shared.nodes.held[i] = 0;
    shared.nodes.held[4] = 7;
    EXPECT_GT(shared.mortar().nodes().size(), 0u) << d;
    Facet on_both = shared.pairs[0].master.facets[0];
    for (const Facet& f : shared.pairs[0].slave.facets)
      for (int v = 0; v < d; ++v)
        if (shared.nodes.X[f.node[v]][0] < 0.6) {
          on_both.node[0] = f.node[v];
          shared.pairs[0].master.facets.push_back(on_both);
        }
    EXPECT_THROW(shared.mortar(), IllegalInput) << d << "shared";
  }
}

namespace {

/// Where between a and b what `differs` measures jumps, by halving.
template <class Scene, class Difference>
Real jump(const Scene& scene, Real a, Real b, const Difference& differs) {
  Mortar low = scene(a).mortar(), high = scene(b).mortar();
  while (b - a > little / 10) {
    const Real middle = (a + b) / 2;
    const Mortar at = scene(middle).mortar();
    const bool above = differs(low, at) < differs(at, high);
    (above ? a : b) = middle;
    (above ? low : high) = at;
  }
  return (a + b) / 2;
}

Real change_of_normals(const Mortar& a, const Mortar& b) {
  Real most = 0;
  for (std::size_t k = 0; k < a.nodes().size(); ++k)
    most = std::max(most, (a.nodes()[k].normal - b.nodes()[k].normal).norm());
  return most;
}

/// An arc about (x, 1), in 3D (x, ., 1), from `from` to `to` beside its lowest point.
std::function<Vec3(const Vec3&)> arc(int d, Real radius, Real x, Real from, Real to) {
  return [=](const Vec3& at) {
    const Real angle = from + (to - from) * at[0];
    Vec3 y = at;
    y[0] = x + radius * std::sin(angle);
    y[d - 1] = 1 - radius * std::cos(angle);
    return y;
  };
}

/// A slave that is held, before a master that may turn about (0, 1).
Surfaces before_wheel(int d, const std::function<Vec3(const Vec3&)>& slave, int slaves,
                      const std::function<Vec3(const Vec3&)>& wheel) {
  Surfaces s(d);
  s.pairs[0].slave = s.sheet(slaves, 1, slave, 2);
  const std::size_t held = s.nodes.X.size();
  s.pairs[0].master = s.sheet(8, -1, wheel, 1);
  s.options.freedom = [=, all = s.nodes.X.size()] {
    const Index k = d == 2 ? 3 : 6;
    Freedom freedom{
        RigidGenerators(d, Vec3::Unit(d - 1), 1), std::vector<Index>(all, 1), {}, {}, {}};
    std::fill_n(freedom.body.begin(), held, 0);
    set_free({DenseMatrix(k, 0), DenseMatrix::Identity(k, k).col(d == 2 ? 2 : 4)}, freedom);
    return freedom;
  };
  return s;
}

}  // namespace

TEST(MortarIncrement, TheSideWhoseNormalsCountStaysTheOne) {
  for (int d : {2, 3}) {
    const auto oval = [d](Real by) {  // on which no turn slips
      return before_wheel(d, lifted(d, -1e-3, -1, 1), 4, [=, round = arc(d, 1, 0, -1, 1)](Vec3 x) {
        x = round(x);
        x[0] *= 1 + by;
        return x;
      });
    };
    const Real at = jump(oval, 1e-4, 0.2, change_of_normals);
    expect_continuous([&](Real t) { return oval(at + t); }, hold_facing);
  }
}

/// Times `little`: angles of 1e-7 are told from their cosines to 1e-9.
constexpr Real beyond_rounding = 5e3;

TEST(MortarIncrement, AFacetThatIsFlatStaysSo) {
  for (int d : {2, 3}) {
    const auto bent = [d](Real angle) {  // two facets of a flat slave, by hardly more than rounding
      return before_wheel(
          d,
          [=](const Vec3& x) {
            Vec3 y = lifted(d, -1e-3, -1, 1)(x);
            y[d - 1] -= angle * std::max<Real>(0, y[0]);
            return y;
          },
          4, arc(d, 1, 0, -1, 1));
    };
    const Real at = jump(bent, 0.5e-7, 6e-7, change_of_normals);
    expect_continuous([&](Real t) { return bent(at + beyond_rounding * t); }, hold_facing, 1e-7);
  }
}

namespace {

/// An arc whose vertices are off it by `rough`, to and fro.
std::function<Vec3(const Vec3&)> rough_arc(int d, Real radius, Real rough, int cells) {
  return [=](const Vec3& at) {
    const Real off = static_cast<int>(std::lround(cells * at[0])) % 2 ? rough : -rough;
    return arc(d, radius + off, 0, -1, 1)(at);
  };
}

/// A rough slave of which a master covers what lies beyond `from`.
Surfaces on_rough_arc(int d, Real rough, Real from = -1.2) {
  Surfaces s(d);
  s.pairs[0].slave = s.sheet(8, -1, rough_arc(d, 1, rough, 8), 2);
  s.pairs[0].master = s.sheet(9, 1, arc(d, 1.05, 0, from, 1.2), 1);
  return s;
}

}  // namespace

TEST(MortarIncrement, AMotionThatNormalsLetSlipStaysOne) {
  for (int d : {2, 3}) {
    const Real at =
        jump([d](Real rough) { return on_rough_arc(d, rough); }, 0, 4e-3, change_of_normals);
    expect_continuous([&](Real t) { return on_rough_arc(d, at + t); }, hold_facing);
    const auto rough_wheel = [d](Real rough) {
      const auto wheel = [=](Vec3 x) {
        if (d == 3) x[1] = 1.2 * x[1] - 0.1;  // no edge lies over one of the slave
        return rough_arc(d, 1, rough, 8)(x);
      };
      return before_wheel(d, lifted(d, -1e-3, -1, 1), 5, wheel);
    };
    const Real of_wheel = jump(rough_wheel, 0, 4e-3, change_of_normals);
    expect_continuous([&](Real t) { return rough_wheel(of_wheel + t); }, hold_facing);
  }
}

TEST(MortarIncrement, AMotionStaysOneWhereNormalsResistItSomewhatMore) {
  for (int d : {2, 3}) {
    const Real at =
        jump([d](Real rough) { return on_rough_arc(d, rough); }, 0, 4e-3, change_of_normals);
    Surfaces s = on_rough_arc(d, 3 * at);
    const auto work_left = [&] {  // of normals in the rotation that they let slip
      const Mortar mortar = s.mortar();
      DenseMatrix work(mortar.nodes().size(), d == 2 ? 3 : 6);
      for (std::size_t k = 0; k < mortar.nodes().size(); ++k) {
        const SlaveNode& node = mortar.nodes()[k];
        const Vec3 n = node.normal, turn = s.nodes.X[node.node].cross(n);
        if (d == 2)
          work.row(Index(k)) << n[0], n[1], turn[2];
        else
          work.row(Index(k)) << n.transpose(), turn.transpose();
      }
      return eigenpairs(work.transpose() * work).values[d == 2 ? 0 : 1];
    };
    EXPECT_GT(work_left(), 1e-10) << d;
    s.nodes.before = on_rough_arc(d, 0.9 * at).nodes.X;
    EXPECT_LT(work_left(), 1e-14) << d;
  }
}

TEST(MortarIncrement, WhatASlaveLetSlipThatWasFlatDoesNotDependOnTheNamesOfBodies) {
  for (int d : {2, 3}) {
    Surfaces s = on_rough_arc(d, 1e-4), flat(d);
    flat.pairs[0].slave = flat.sheet(8, -1, lifted(d, 0.05, -0.8, 0.8), 2);
    flat.pairs[0].master = flat.sheet(9, 1, lifted(d, 0, -1, 1), 1);
    s.nodes.before = flat.nodes.X;
    const Mortar nameless = s.mortar();
    s.options.bodies = [all = s.nodes.X.size()] { return std::vector<Index>(all, 1); };
    const Mortar named = s.mortar();
    ASSERT_GT(named.nodes().size(), 5u);
    EXPECT_EQ(change(nameless, named), 0) << d;
    s.nodes.before.clear();  // where it is decided now normals follow
    EXPECT_GT(change_of_normals(s.mortar(), named), 1e-6) << d;
  }
}

TEST(MortarIncrement, WhatFewNodesLetSlipIsNotForcedOnTheManyThatComeAfter) {
  for (int d : {2, 3}) {
    const auto oval = [d](Real from) {
      Surfaces scene = on_rough_arc(d, 1e-4, from);
      for (Vec3& x : scene.nodes.X) x[d - 1] *= 0.5;
      return scene;
    };
    Surfaces s = oval(-1.2);
    const Mortar by_itself = s.mortar();
    s.nodes.before = oval(0.9).nodes.X;
    const Mortar mortar = s.mortar();
    ASSERT_EQ(mortar.nodes().size(), by_itself.nodes().size());
    EXPECT_LT(change_of_normals(mortar, by_itself), 1e-2) << d;
  }
}

TEST(MortarIncrement, ARowThatSeesTheMasterAlongALineStaysOne) {
  const auto on_needle = [](Real width) {
    Surfaces s(3);
    s.pairs[0].slave = s.sheet(
        3, -1,
        [=](const Vec3& x) {
          const Real y = x[1] - 0.45;
          return Vec3(0.4 + width * 0.3 * x[0], width * y,
                      width * (0.01 + 0.3 * y * y + 0.02 * x[0] * x[0]));
        },
        2);
    s.pairs[0].master = s.sheet(
        1, 1, [=](const Vec3& x) { return Vec3(x[0], width * (2 * x[1] - 1), 0); }, 1);
    return s;
  };
  const Real at = jump(on_needle, 7.085e-4, 7.105e-4, change);
  expect_continuous([&](Real t) { return on_needle(at + t * 1e-2); }, hold_facing);
}

TEST(MortarIncrement, ANodeStaysWithTheWayInWhichItSeesTheMaster) {
  for (int d : {2, 3}) {
    const auto wheel_before_flat = [d](Real turn) {  // weights can follow a node's normal, or not
      return before_wheel(d, lifted(d, -1e-3, -1, 1), 4, arc(d, 1, 0, turn - 1.4, turn + 1.4));
    };
    const Real at = jump(wheel_before_flat, 0.08, 0.1, change);
    expect_continuous([&](Real t) { return wheel_before_flat(at + t); }, hold_facing);
  }
}

TEST(MortarIncrement, ANodeThatHasPassedToAnotherBodySeesThatAsByItself) {
  for (int d : {2, 3}) {
    Surfaces s = before_wheel(d, lifted(d, -1e-3, -1, 1), 4, arc(d, 1, 0, -1.3, 1.5));
    const Index of_wheel = static_cast<Index>(s.nodes.X.size());
    append(s.pairs[0].master, s.sheet(5, -1, lifted(d, 0.01, 8.9, 11.2), 1));
    s.options.freedom = [=, wheel = s.options.freedom, all = s.nodes.X.size()] {
      Freedom freedom = wheel();
      freedom.body.resize(all, 2);
      freedom.of_body.push_back(freedom.of_body[0]);
      freedom.stiffness.push_back(freedom.stiffness[0]);
      return freedom;
    };
    Surfaces passed = s;
    for (Index i = 0; i < static_cast<Index>(s.nodes.X.size()); ++i)
      passed.nodes.X[i][0] -= i < of_wheel ? 0 : 10;
    for (Index i = s.pairs[0].master.facets[0].node[0]; i < of_wheel; ++i)
      passed.nodes.X[i][0] -= 10;
    Surfaces begun = passed;
    begun.nodes.before = s.nodes.X;
    EXPECT_EQ(change(begun.mortar(), passed.mortar()), 0) << d;
    EXPECT_GT(change(s.mortar(), passed.mortar()), 0.1) << d;
  }
}

TEST(MortarIncrement, TheSlaveOfASurfaceThatTouchesItselfStaysIt) {
  for (int d : {2, 3}) {
    const auto opening = [d](Real length) {  // smaller facets are slaves, or those that come first
      Surfaces s(d);
      Surface all = s.sheet(4, -1, lifted(d, 0.1, 0, 1), 1);
      append(all, s.sheet(4, 1, lifted(d, 0, -0.1, length - 0.1), 1));
      s.pairs[0].slave = s.pairs[0].master = all;
      return s;
    };
    const Real at = jump(opening, 1, 1.3, change);
    expect_continuous([&](Real t) { return opening(at + t); }, hold_facing);
  }
}

TEST(MortarIncrement, GivenNormalsAreThoseOfNowAndNoSlipIsKnown) {
  const Surfaces start = before_wheel(2, lifted(2, -1e-3, -1, 1), 4, arc(2, 1, 0, -1, 1));
  Surfaces s = start;
  for (Vec3& x : s.nodes.X) x = -x;
  for (Surface* surface : {&s.pairs[0].slave, &s.pairs[0].master})
    for (Facet& f : surface->facets) f.outward *= -1;
  s.nodes.before = start.nodes.X;
  EXPECT_EQ(s.mortar().slip().size(), s.mortar().nodes().size());
  s.options.normals.assign(5, Vec3(0.1, -1, 0));
  s.options.freedom = [&] {
    ADD_FAILURE() << "normals are given";
    return start.options.freedom();
  };
  EXPECT_TRUE(s.mortar().slip().empty());
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
        hold_edges);
}

TEST(MortarIncrement, ANormalIsHeldWhereItIsSoWithoutDeformation) {
  const auto sloped = [](Real slope) {
    Surfaces s(2);
    const auto tilted = [=](const Vec3& x) { return Vec3(x[0], slope * x[0], 0); };
    s.pairs[0].master = s.sheet(3, 1, tilted, 1);
    s.pairs[0].slave = s.sheet(4, -1, tilted, 2);
    s.nodes.held.assign(s.nodes.X.size(), 0);
    s.nodes.held.back() = 1;  // x, as on an axis
    return s;
  };
  const Surfaces flat = sloped(0), tilted = sloped(0.3);
  for (bool increment : {false, true})
    for (Real slope : {0., 0.3, 60.}) {  // of the last one nothing is left free
      Surfaces s = sloped(slope);
      if (increment) s.nodes.before = s.nodes.X;
      s.nodes.reference = flat.nodes.X;
      EXPECT_EQ(s.mortar().statistics().held, slope > 1 ? 1 : 0) << slope;
      EXPECT_EQ(s.mortar().nodes().size(), slope > 1 ? 4 : 5) << slope;
      s.nodes.reference = tilted.nodes.X;
      EXPECT_EQ(s.mortar().statistics().held, 1) << slope;
      s.options.normals.assign(9, Vec3(0, -1, 0));  // of now
      EXPECT_EQ(s.mortar().statistics().held, 0) << slope;
    }
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

TEST(MortarIncrement, WhatIsBarelyCoveredStaysWithTheNodeThatMoreIsCoveredAround) {
  for (int d : {2, 3}) {
    Surfaces s(d);
    s.pairs[0].slave = s.sheet(4, -1, lifted(d, 0.1, 0, 1), 2);
    s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0, 0.75 + 1e-4), 1);
    s.nodes.X[3][d - 1] += 0.01;
    Surfaces begun = s;
    begun.nodes.before = s.nodes.X;
    EXPECT_EQ(change(begun.mortar(), s.mortar()), 0) << d;
  }
}

TEST(MortarIncrement, NormalsThatTheMasterGivesStandStillInTheStiffness) {
  for (int d : {2, 3}) {
    Surfaces s = before_wheel(d, lifted(d, -1e-3, -0.8, 0.8), 4, arc(d, 1, 0, -1, 1)), given = s;
    given.options.normals.assign(d == 2 ? 5 : 25, Vec3::Unit(d - 1));
    Index turned = 0;
    const Mortar mortar = s.mortar();
    for (const SlaveNode& node : mortar.nodes()) {
      given.options.normals[node.node] = node.normal;
      turned += std::abs(node.normal[0]) > 0.1;
    }
    EXPECT_GT(turned, 1);
    const auto stiffness = [d](Surfaces scene) {
      const Mortar plain = scene.mortar();
      scene.options.force.assign(scene.nodes.X.size(), Vec3::Zero());
      for (Index k = 0; k < plain.relative().rows(); ++k)
        for (Matrix::InnerIterator G(plain.relative(), k); G; ++G)
          scene.options.force[G.col()] -= G.value() * plain.nodes()[k].normal;
      const Index n = 3 * static_cast<Index>(scene.nodes.X.size());
      DenseMatrix S = DenseMatrix::Zero(n, n);
      const Mortar loaded = scene.mortar();
      for (const auto& [ij, block] : loaded.stiffness().forces)
        S.block<3, 3>(3 * ij.first, 3 * ij.second) += block;
      return S;
    };
    const DenseMatrix S = stiffness(s);
    EXPECT_GT(S.cwiseAbs().maxCoeff(), 0.1);
    EXPECT_LT((S - stiffness(given)).cwiseAbs().maxCoeff(), 1e-9) << d;
  }
}

TEST(MortarIncrement, BodiesThatTurnFarKeepWhatTheyFace) {
  const Surfaces start = [] {
    Surfaces s(3);
    s.pairs[0].master = s.sheet(5, 1, lifted(3, 0, 0, 0.53), 1);
    append(s.pairs[0].master, s.sheet(4, 1, lifted(3, -0.1, 0.53, 1), 1));
    s.pairs[0].slave = s.sheet(6, -1, lifted(3, 0, 0, 1), 2);
    return s;
  }();
  const Eigen::Matrix3d Q =
      (Eigen::AngleAxisd(2.5, Vec3(1, 2, 0).normalized()) * Eigen::AngleAxisd(1, Vec3::UnitZ()))
          .toRotationMatrix();
  Surfaces turned = start;
  turn(Q, turned);
  turned.nodes.before = turned.nodes.reference = start.nodes.X;
  const Mortar a = start.mortar(), b = turned.mortar();
  ASSERT_EQ(a.nodes().size(), b.nodes().size());
  EXPECT_LT(DenseMatrix(a.relative() - b.relative()).cwiseAbs().maxCoeff(), 1e-12);
  for (std::size_t k = 0; k < a.nodes().size(); ++k) {
    EXPECT_NEAR(a.nodes()[k].gap, b.nodes()[k].gap, 1e-13);
    EXPECT_LT((Q * a.nodes()[k].normal - b.nodes()[k].normal).norm(), 1e-12);
  }
  EXPECT_FALSE(steps_of(start).empty());
  EXPECT_EQ(steps_of(start), steps_of(turned));
}

TEST(MortarIncrement, BodiesThatTurnFarWereNotBehindEachOther) {
  for (int d : {2, 3}) {
    Surfaces s(d);
    s.pairs[0].slave = s.sheet(4, -1, lifted(d, 0.5, 0, 1), 2);
    s.pairs[0].master = s.sheet(5, 1, lifted(d, 0, 0, 1), 1);
    const std::size_t nodes = s.mortar().nodes().size();
    s.nodes.before = s.nodes.X;
    for (Vec3& x : s.nodes.X) x = Vec3((d == 2 ? -1 : 1) * x[0], -x[1], -x[2]);
    for (Surface* surface : {&s.pairs[0].slave, &s.pairs[0].master})
      for (Facet& f : surface->facets) f.outward *= -1;
    EXPECT_EQ(s.mortar().nodes().size(), nodes);
  }
}
