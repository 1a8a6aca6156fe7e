#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <random>

#include "core/assembly/mortar/normals.h"
#include "surfaces.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

using Map = std::function<Vec3(const Vec3&)>;

/// An uneven slave on an uneven master of one shape.
Surfaces uneven_pair(int d, bool quadratic, const Map& shape, unsigned seed = 1) {
  Surfaces s(d, quadratic);
  std::mt19937 random(seed);
  std::uniform_real_distribution<Real> by(-0.3, 0.3);
  const auto jittered = [&](int n) -> Map {
    return [&, n](const Vec3& x) {
      Vec3 y = x;
      for (int c = 0; c < d - 1; ++c)
        if (x[c] > 0 && x[c] < 1) y[c] += by(random) / n;
      return shape(y);
    };
  };
  s.pairs[0].slave = s.sheet(7, 1, jittered(7), 2);
  s.pairs[0].master = s.sheet(9, -1, jittered(9), 1);
  return s;
}

Vec3 on_cylinder(const Vec3& x) {
  const Real t = 1.5 * (x[0] - 0.5);
  return Vec3(std::sin(t), 2 * x[1], std::cos(t));
}
Vec3 on_circle(const Vec3& x) {
  const Vec3 p = on_cylinder(x);
  return Vec3(p[0], p[2], 0);
}

}  // namespace

TEST(MortarNormals, OnCirclesAndCylindersTheyAreExactWhateverTheFacetsAndAtRims) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      const Surfaces s = uneven_pair(d, quadratic, d == 2 ? on_circle : on_cylinder);
      const Mortar mortar = s.mortar();
      EXPECT_EQ(mortar.nodes().size(), d == 2 ? 8u : 64u);
      for (const SlaveNode& node : mortar.nodes()) {
        Vec3 n = s.nodes.X[node.node];
        if (d == 3) n[1] = 0;
        EXPECT_LT((node.normal - n.normalized()).norm(), 1e-12);
      }
    }
}

/// Places off the cylinder by up to a thousandth of its radius, aside by `shift`, or of an oval.
Map near_cylinder(std::mt19937& random, Real shift = 0, Real height = 1) {
  return [=, &random](const Vec3& x) {
    const Vec3 p = on_cylinder(x);
    const Real r = 1 + std::uniform_real_distribution<Real>(-1e-3, 1e-3)(random);
    return Vec3(r * p[0] + shift, p[1], height * r * p[2]);
  };
}

/// How normals resist rigid motions, of the nodes from `first` on, before `last`: sorted.
Vector resistances(const Surfaces& s, Index first = 0,
                   Index last = std::numeric_limits<Index>::max()) {
  const Mortar mortar = s.mortar();
  Eigen::MatrixXd work = Eigen::MatrixXd::Zero(mortar.nodes().size(), 6);
  for (std::size_t k = 0; k < mortar.nodes().size(); ++k) {
    const auto& [i, pair, label, n, weight, gap, distance, own] = mortar.nodes()[k];
    if (i >= first && i < last)
      work.row(Index(k)) << n.transpose(), s.nodes.X[i].cross(n).transpose();
  }
  return Eigen::JacobiSVD<Eigen::MatrixXd>(work).singularValues();
}

TEST(MortarNormals, ABodyThatMayTurnAsFarAsItsMeshTellsTurnsWithoutGap) {
  // no normal resists the rotation, though vertices do not tell it
  std::mt19937 random(5);
  const Vector sizes = resistances(uneven_pair(3, false, near_cylinder(random)));
  EXPECT_LT(sizes[4], 1e-12);  // along the axis, and around it
  EXPECT_GT(sizes[3], 0.05);
}

TEST(MortarNormals, ABodyThatSupportsLeaveToTurnTurnsAboutTheirAxis) {
  // the axis that rough vertices tell is tilted, and the supports resist what that adds
  for (bool slave_turns : {true, false}) {
    std::mt19937 random(5);
    Surfaces s = uneven_pair(3, false, near_cylinder(random));
    const auto wedge = [&] {
      Real most = 0;
      const Mortar mortar = s.mortar();
      for (const SlaveNode& node : mortar.nodes())
        most = std::max(most, std::abs(Vec3::UnitY().cross(s.nodes.X[node.node]).dot(node.normal)));
      return most;
    };
    EXPECT_GT(wedge(), 1e-6);
    std::vector<Index> body(s.nodes.X.size(), slave_turns ? 1 : 0);
    for (const Facet& f : s.pairs[0].slave.facets)
      for (int v = 0; v < 3; ++v) body[f.node[v]] = slave_turns ? 0 : 1;
    s.options.freedom = [body] {
      Freedom freedom{RigidGenerators(3, Vec3(0.4, 0.1, -0.3), 2), body, {}, {}, {}};
      set_free({freedom.generators.about(Vec3::Zero(), 4), DenseMatrix(6, 0)}, freedom);
      return freedom;
    };
    EXPECT_LT(wedge(), 1e-15) << slave_turns;
  }
}

TEST(MortarNormals, EachBodyHasMotionsOfItsOwn) {
  // two cylinders side by side, rough, with other axes: together they leave one motion alone
  std::mt19937 random(5);
  Surfaces s(3);
  s.pairs[0].slave = s.sheet(7, 1, near_cylinder(random), 2);
  const Index second = static_cast<Index>(s.nodes.X.size());
  append(s.pairs[0].slave, s.sheet(7, 1, near_cylinder(random, 3), 2));
  const Index slaves = static_cast<Index>(s.nodes.X.size());
  s.pairs[0].master = s.sheet(9, -1, near_cylinder(random), 1);
  append(s.pairs[0].master, s.sheet(9, -1, near_cylinder(random, 3), 1));
  for (bool apart : {true, false}) {
    if (apart)
      s.options.bodies = [=] {
        std::vector<Index> body(slaves, 0);
        std::fill(body.begin() + second, body.end(), 1);
        return body;
      };
    else
      s.options.bodies = nullptr;
    const Vector sizes = resistances(s, 0, second);
    EXPECT_EQ(sizes[4] < 1e-12, apart) << sizes.transpose();
  }
}

TEST(MortarNormals, WhatOneBodyOrPairResistsIsLeftToOthers) {
  // a rough cylinder beside an oval, which resists the rotation
  std::mt19937 random(5);
  for (bool two_pairs : {false, true}) {
    Surfaces s(3);
    s.pairs.resize(two_pairs ? 2 : 1);
    s.pairs[0].slave = s.sheet(7, 1, near_cylinder(random, 0, 0.5), 2);
    const Index cylinder = static_cast<Index>(s.nodes.X.size());
    const Surface slave = s.sheet(7, 1, near_cylinder(random, 3), 2);
    s.pairs[0].master = s.sheet(9, -1, near_cylinder(random, 0, 0.5), 1);
    const Surface master = s.sheet(9, -1, near_cylinder(random, 3), 1);
    if (two_pairs) s.pairs[1] = {slave, master};
    if (!two_pairs) {
      append(s.pairs[0].slave, slave);
      append(s.pairs[0].master, master);
      s.options.bodies = [=, all = s.nodes.X.size()] {
        std::vector<Index> body(all, 1);
        std::fill_n(body.begin(), cylinder, 0);
        return body;
      };
    }
    const Vector sizes = resistances(s, cylinder);
    EXPECT_LT(sizes[4], 1e-12) << two_pairs;
    EXPECT_GT(sizes[3], 0.05) << two_pairs;
  }
}

TEST(MortarNormals, WhereSurfacesOfOnePatchMeetAreTheMeanByMeasure) {
  const Nodes nodes{2, {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(3, 1, 0)}, {}};
  Surface corner;
  for (Index i : {0, 1}) {
    Facet facet;
    facet.node[0] = i, facet.node[1] = i + 1;
    facet.outward = Vec3(i, i - 1, 0);
    corner.facets.push_back(facet);
  }
  const Sides of{nodes, {Side(2, corner, nodes.X)}};
  Slipping undecided;
  const std::vector<Vec3> normal = slave_normals(
      of, {}, [](std::size_t, Index, Index) { return true; }, undecided);
  EXPECT_EQ(normal[0], Vec3(0, -1, 0));
  EXPECT_LT((normal[1] - Vec3(1, -3, 0).normalized()).norm(), 1e-15);
}

TEST(MortarNormals, OfFlatFacesTheyAreTheFacetsToTheLastBit) {
  for (int d : {2, 3}) {
    const Surfaces s = uneven_pair(d, false, same);
    const Mortar mortar = s.mortar();
    for (const SlaveNode& node : mortar.nodes()) EXPECT_EQ(node.normal, Vec3(Vec3::Unit(d - 1)));
  }
}

namespace {

/// A cap of the unit sphere around (0, 1), in 3D (0, 0, 1), and a flat below it, which gives way.
Surfaces cap_on_flat(int d, bool cap_is_slave) {
  Surfaces s(d);
  const Vec3 middle(0.5, d == 3 ? 0.5 : 0, 0);
  const Map cap = [=](const Vec3& x) {
    Vec3 y = (x - middle) * 0.8;
    y[d - 1] = 0;
    y[d - 1] = 1 - std::sqrt(1 - y.squaredNorm());
    return y;
  };
  const Map flat = [=](const Vec3& x) {
    Vec3 y = 1.5 * (x - middle);
    y[d - 1] = -0.05;
    return y;
  };
  s.pairs[0].slave = cap_is_slave ? s.sheet(8, -1, cap, 2) : s.sheet(9, 1, flat, 2);
  s.pairs[0].master = cap_is_slave ? s.sheet(9, 1, flat, 1) : s.sheet(8, -1, cap, 1);
  return s;
}

/// The cap may move by the columns of `motions`, of generators about its centre; the flat is held.
Options capping(const Surfaces& s, bool cap_is_slave, const DenseMatrix& motions) {
  const int d = s.nodes.dimension;
  Options options;
  options.freedom = [=, n = s.nodes.X.size(), X = s.nodes.X] {
    Freedom freedom{RigidGenerators(d, Vec3::Unit(d - 1), 1), {}, {}, {}, {}};
    for (std::size_t i = 0; i < n; ++i)  // the flat alone lies below 0
      freedom.body.push_back((X[i][d - 1] < 0) == cap_is_slave);
    const DenseMatrix none(motions.rows(), 0);
    set_free({cap_is_slave ? motions : none, cap_is_slave ? none : motions}, freedom);
    return freedom;
  };
  return options;
}

}  // namespace

TEST(MortarNormals, BetweenAFlatAndACapTheyLetSlipWhatIsFreeWhicheverIsSlave) {
  for (int d : {2, 3})
    for (bool cap_is_slave : {true, false}) {
      const Index k = d == 2 ? 3 : 6, turns = d == 2 ? 1 : 3;
      const DenseMatrix all = DenseMatrix::Identity(k, k), along = all.leftCols(1),
                        turn = all.rightCols(turns);
      const Vec3 down = -Vec3::Unit(d - 1), outward = cap_is_slave ? down : Vec3(-down);
      const auto furthest = [&](const DenseMatrix& motions, auto&& expected) {
        Surfaces s = cap_on_flat(d, cap_is_slave);
        if (motions.cols() > 0) s.options = capping(s, cap_is_slave, motions);
        const Mortar mortar = s.mortar();
        Real off = 0;
        for (const SlaveNode& node : mortar.nodes())
          off = std::max(off, (node.normal - expected(s.nodes.X[node.node])).norm());
        return off;
      };
      const auto radial = [&](const Vec3& x) -> Vec3 {
        return (x - Vec3::Unit(d - 1)).normalized() * (cap_is_slave ? 1 : -1);
      };
      const auto flat = [&](const Vec3&) { return outward; };
      EXPECT_LT(furthest(along, flat), 1e-12) << d << cap_is_slave;
      EXPECT_LT(furthest(turn, radial), 1e-12) << d << cap_is_slave;
      EXPECT_LT(furthest(all, flat), 1e-12) << d << cap_is_slave;
      const DenseMatrix none(k, 0);
      EXPECT_LT(cap_is_slave ? furthest(none, radial) : furthest(none, flat), 1e-12) << d;
    }
}

namespace {

/// A flat below, and a face that leans by 40 degrees up to `until`, the rest of which lies.
Surfaces chamfer_on_flat(int d, Real until, bool alone) {
  Surfaces s(d);
  const auto leaning = [=](Real from, Real to) {
    return [=](const Vec3& x) {
      Vec3 y = x;
      y[0] = from + (to - from) * x[0];
      y[d - 1] = std::max<Real>(until - y[0], 0) * 0.84;
      return y;
    };
  };
  if (alone) {
    s.pairs.resize(2);
    s.pairs[0].slave = s.sheet(7, -1, leaning(until, 1), 2);
    s.pairs[1].slave = s.sheet(3, -1, leaning(0, until), 3);
  } else {
    s.pairs[0].slave = s.sheet(10, -1, leaning(0, 1), 2);
  }
  s.pairs[0].master = s.sheet(9, 1, lifted(d, -0.05, -0.5, 1.5), 1);
  if (alone) s.pairs[1].master = s.pairs[0].master;
  return s;
}

}  // namespace

TEST(MortarNormals, AChamferHasTheFlatsWhereTheFaceBesideItLiesThere) {
  for (int d : {2, 3})
    for (bool alone : {false, true})
      for (bool is_free : {true, false}) {
        Surfaces s = chamfer_on_flat(d, 0.3, alone);
        const Index k = d == 2 ? 3 : 6;
        s.options = capping(s, true, DenseMatrix::Identity(k, is_free ? k : 0));
        const Mortar mortar = s.mortar();
        EXPECT_GT(mortar.nodes().size(), d == 2 ? 9u : 70u);
        for (const SlaveNode& node : mortar.nodes())
          EXPECT_LT((node.normal + Vec3::Unit(d - 1)).norm(), 1e-12)
              << d << alone << is_free << " at " << s.nodes.X[node.node].transpose();
      }
}

TEST(MortarNormals, AFaceThatLeansAsAWholeKeepsItsOwn) {
  for (int d : {2, 3}) {
    Surfaces s = chamfer_on_flat(d, 1, false);
    const Index k = d == 2 ? 3 : 6;
    s.options = capping(s, true, DenseMatrix::Identity(k, k));
    const Mortar mortar = s.mortar();
    for (const SlaveNode& node : mortar.nodes()) {
      const Vec3& x = s.nodes.X[node.node];
      const bool inside = x[0] > 0.05 && x[0] < 0.95 && (d == 2 || std::abs(x[1] - 0.5) < 0.45);
      if (!inside) continue;
      EXPECT_GT((node.normal + Vec3::Unit(d - 1)).norm(), 0.3) << d;
    }
  }
}

TEST(MortarNormals, ABodyThatLiesChangesNoneThatLeansBesideIt) {
  for (int d : {2, 3}) {
    Surfaces s = chamfer_on_flat(d, 1, false);
    const std::size_t leaning = s.nodes.X.size();
    const auto normals = [&] {
      const Index k = d == 2 ? 3 : 6;
      s.options = capping(s, true, DenseMatrix::Identity(k, k));
      s.options.freedom = [=, n = s.nodes.X.size(), plain = s.options.freedom] {
        Freedom freedom = plain();
        for (std::size_t i = leaning; i < n; ++i) freedom.body[i] = 2;
        freedom.of_body.push_back(freedom.of_body[1]);
        freedom.stiffness.push_back(freedom.stiffness[1]);
        return freedom;
      };
      std::map<Index, Vec3> of_node;
      const Mortar mortar = s.mortar();
      for (const SlaveNode& node : mortar.nodes()) of_node[node.node] = node.normal;
      return of_node;
    };
    const auto alone = normals();
    append(s.pairs[0].slave, s.sheet(2, -1, lifted(d, 0, 1.1, 1.4), 2));
    const auto beside = normals();
    EXPECT_GT(beside.size(), alone.size());
    for (const auto& [i, n] : alone) EXPECT_EQ(beside.at(i), n) << d;
  }
}

TEST(MortarNormals, WhereSupportsHoldBothBodiesChamfersHaveTheFlatsAndCapsTheirOwn) {
  for (int d : {2, 3}) {
    const auto off = [&](Surfaces s, bool upper_is_slave, const auto& expected) {
      s.options = capping(s, upper_is_slave, DenseMatrix(d == 2 ? 3 : 6, 0));
      s.options.freedom = [plain = s.options.freedom] {
        Freedom freedom = plain();
        freedom.support = freedom.stiffness;
        return freedom;
      };
      const Mortar mortar = s.mortar();
      Real most = 0;
      for (const SlaveNode& node : mortar.nodes())
        most = std::max(most, (node.normal - expected(s.nodes.X[node.node])).norm());
      return most;
    };
    const Vec3 down = -Vec3::Unit(d - 1);
    const auto flat = [&](const Vec3&) { return down; };
    const auto radial = [&](const Vec3& x) { return Vec3((x + down).normalized()); };
    EXPECT_LT(off(chamfer_on_flat(d, 0.3, false), true, flat), 1e-12) << d;
    EXPECT_LT(off(cap_on_flat(d, true), true, radial), 1e-12) << d;
  }
}
