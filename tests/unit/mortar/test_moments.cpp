#include <gtest/gtest.h>

#include "core/assembly/mortar/moments.h"
#include "surfaces.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

using Map = std::function<Vec3(const Vec3&)>;

Vec3 turned(int d, const Vec3& x) {
  const Vec3 axis = d == 2 ? Vec3::UnitZ() : Vec3(1, 2, 3).normalized();
  return Eigen::AngleAxisd(0.7, axis) * x;
}

/// Two meshes of n and m cells of one uneven, turned surface: an arc, in 3D a part of a sphere
/// (curved = 1) or a saddle that bends ever more (curved = 2); flat where curved = 0.
Surfaces pair_on(int d, bool quadratic, int curved, int n, int m, Real reach = 1) {
  Surfaces s(d, quadratic);
  const auto shape = [=](int mesh) -> Map {
    return [=](const Vec3& o) {
      Vec3 x = o;  // uneven, another way on each mesh
      if (mesh == 1) x[0] = reach * (x[0] + 0.12 * std::sin(5 * x[0]) * (1 - x[0]));
      if (mesh == 0) x[0] += 0.08 * std::sin(9 * x[0]) * (1 - x[0]);
      if (d == 3) x[1] += 0.1 * x[0] * x[1] * (1 - x[1]) * (mesh == 0 ? 1 : -1);
      const Real a = x[0] - 0.5, b = d == 3 ? x[1] - 0.5 : 0;
      Real lift = 0;
      if (curved == 1) lift = std::sqrt(1 - a * a - b * b);
      if (curved == 2) lift = 0.3 * a * a - 0.2 * b * b + 0.1 * a * a * a;
      Vec3 y = x;
      y[d - 1] = lift;
      return turned(d, y);
    };
  };
  s.pairs[0].slave = s.sheet(n, -1, shape(0), 2);
  s.pairs[0].master = s.sheet(m, 1, shape(1), 1);
  for (auto* side : {&s.pairs[0].slave, &s.pairs[0].master})
    for (Facet& f : side->facets) f.outward = turned(d, f.outward);
  return s;
}

/// sum_l G_kl (X_l - X_i)
Vec3 arm(const Surfaces& s, const Mortar& mortar, Index k) {
  Vec3 sum = Vec3::Zero();
  for (Matrix::InnerIterator it(mortar.relative(), k); it; ++it)
    sum += it.value() * (s.nodes.X[it.col()] - s.nodes.X[mortar.nodes()[k].node]);
  return sum;
}

/// Of forces on both bodies, along the normals or in any direction: their sum and their moment,
/// without the couples of the tangential ones with what lies between the bodies, over their size.
std::pair<Real, Real> imbalance(const Surfaces& s, const Mortar& mortar, bool friction) {
  const Matrix& G = mortar.relative();
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero(), couples = Vec3::Zero();
  Real size = 0;
  for (Index k = 0; k < G.rows(); ++k) {
    Vec3 y = mortar.nodes()[k].normal * (1 + std::sin(7. * k));
    if (friction) y += Vec3(std::sin(3. * k), std::cos(2. * k), s.nodes.dimension == 3);
    couples += mortar.nodes()[k].normal.dot(arm(s, mortar, k)) * mortar.nodes()[k].normal.cross(y);
    size += y.norm();
    for (Matrix::InnerIterator it(G, k); it; ++it) {
      sum += it.value() * y;
      moment += s.nodes.X[it.col()].cross(it.value() * y);
    }
  }
  return {sum.norm() / size, (moment - couples).norm() / size};
}

/// A node at 0 whose normal points along (1, -1), and below it a master from x = a to b, of two
/// halves: P has the first half alone.
struct Aslant {
  Aslant(int d, Real a, Real b) : d_(d) {
    const auto at = [&](Real x, Real y) { return d == 2 ? Vec3(x, -1, 0) : Vec3(x, y, -1); };
    X = {Vec3::Zero()};
    for (Real y : {-1., 2.})
      for (Real x : {a, (a + b) / 2, b})
        if (d == 3 || y < 0) X.push_back(at(x, y));
    for (Index k : {0, 1}) {
      Facet f;
      f.outward = Vec3::Unit(d - 1);
      f.node = {1 + k, 2 + k, -1, -1, -1, -1};
      if (d == 3) f.node[2] = 4 + k;
      surface.facets.push_back(f);
      if (d == 3) f.node = {5 + k, 4 + k, 2 + k, -1, -1, -1}, surface.facets.push_back(f);
    }
    node.normal = (Vec3::Unit(0) - Vec3::Unit(d - 1)).normalized();
    const Index n = static_cast<Index>(X.size());
    P = Matrix(n, n);
    P.insert(0, 1) = 0.7, P.insert(0, 2) = 0.3;
  }
  Matrix G(const Matrix& by) const {
    Matrix G(1, by.cols());
    G.insert(0, 0) = 1;
    for (Matrix::InnerIterator it(by, 0); it; ++it) G.insert(0, it.col()) = -it.value();
    return G;
  }
  Matrix seen(bool of_master) const {
    std::vector<char> all(X.size(), of_master);
    const std::vector<Side> masters = {Side(d_, surface, X)};
    RowChoices undecided;
    return along_normals(P, G(P), {node}, all, masters, X, undecided);
  }
  Vec3 place(const Matrix& by) const {
    Vec3 x = Vec3::Zero();
    for (Matrix::InnerIterator it(by, 0); it; ++it) x += it.value() * X[it.col()];
    return x;
  }

  int d_;
  std::vector<Vec3> X;
  Surface surface;
  SlaveNode node;
  Matrix P;
};

TEST(MortarMoments, ANodeWithTheMastersNormalSeesItWhereTheNormalMeetsIt) {
  for (int d : {2, 3}) {
    const Aslant s(d, -0.5, 1.5);  // met at x = 1, beyond the facet that the row has
    const Matrix seen = s.seen(true);
    EXPECT_LT((s.place(seen) - std::sqrt(2) * s.node.normal).norm(), 1e-14);
    EXPECT_NEAR(seen.row(0).sum(), 1, 1e-15);
    for (Matrix::InnerIterator it(seen, 0); it; ++it) EXPECT_GT(it.value(), 0);
    EXPECT_LT((s.seen(false) - s.P).norm(), 1e-300) << "a normal of its own";
  }
  const Aslant balanced(2, 0.7, 2.7);  // 1 = 0.7 * 0.7 + 0.3 * 1.7
  EXPECT_LT((balanced.seen(true) - balanced.P).norm(), 1e-300);
}

TEST(MortarMoments, WhereThatNormalPassesTheRimItSeesThePointOfTheRimThatIsNearest) {
  for (int d : {2, 3})
    for (Real rim : {0.5, 1 - 1e-6, 1 - 1e-12, 1 - 1e-15, 1., 1 + 1e-12}) {
      const Aslant s(d, rim - 2, rim);  // the normal meets the plane at x = 1
      const Matrix seen = s.seen(true);
      EXPECT_NEAR(seen.row(0).sum(), 1, 1e-14);
      EXPECT_NEAR(s.place(seen)[0], std::min<Real>(rim, 1), 2e-9) << d << ", rim at " << rim;
      EXPECT_LT(std::abs(s.place(seen)[1]) * (d == 3), 1e-14) << "along the rim";
    }
}

/// A flat, the slave, of which a width is before a wheel that may turn about y; its nodes are off
/// their places by up to `noise`.
Surfaces flat_before_wheel(bool quadratic, int facets, Real width, Real aside, Real noise) {
  Surfaces s(3, quadratic);
  const Map flat = [=](const Vec3& x) {
    return Vec3(2 * x[0] - 1, width * (x[1] - 0.5) + aside, -1e-3);
  };
  const Map wheel = [](const Vec3& x) {
    const Real t = 2.8 * (x[0] - 0.5);
    return Vec3(std::sin(t), 0.4 * (x[1] - 0.5), 1 - std::cos(t));
  };
  s.pairs[0].slave = s.sheet(4, 1, flat, 2);
  const std::size_t of_flat = s.nodes.X.size();
  s.pairs[0].master = s.sheet(facets, -1, wheel, 1);
  for (std::size_t i = 0; i < of_flat; ++i)
    for (int c = 0; c < 3; ++c) s.nodes.X[i][c] += noise * std::sin(7. * i + 3 * c);
  s.options.freedom = [=, n = s.nodes.X.size()] {
    Freedom freedom{RigidGenerators(3, Vec3::UnitZ(), 1), std::vector<Index>(n, 1), {}, {}, {}};
    std::fill_n(freedom.body.begin(), of_flat, 0);
    set_free({DenseMatrix(6, 0), DenseMatrix::Identity(6, 6).col(4)}, freedom);
    return freedom;
  };
  return s;
}

/// By how much the wheel's turn changes gaps, at most, over the size of their rows: 1 for a node
/// that sees the wheel at one place, more on slivers, whose weights have no sign.
Real change_of_gaps(const Surfaces& s) {
  const Mortar mortar = s.mortar();
  const RigidGenerators generators = s.options.freedom().generators;
  const std::vector<Index> body = s.options.freedom().body;
  Real most = 0;
  for (Index k = 0; k < mortar.relative().rows(); ++k) {
    Vec3 moves = Vec3::Zero();
    Real size = 0;
    for (Matrix::InnerIterator it(mortar.relative(), k); it; ++it) {
      size += std::abs(it.value()) / 2;
      if (body[it.col()] == 1) moves += it.value() * generators.at(s.nodes.X[it.col()]).col(4);
    }
    most = std::max(most, std::abs(mortar.nodes()[k].normal.dot(moves)) / size);
  }
  return most;
}

}  // namespace

TEST(MortarMoments, AWheelTurnsBeforeAFlatHoweverItsSidesLieAmongTheFlatsNodes) {
  for (bool quadratic : {false, true})
    for (int facets : {8, 11})
      for (Real noise : {0., 1e-13, 1e-11, 1e-9})
        for (auto [width, aside] :  // nodes before the sides, by a hair beside them, or well beside
             std::vector<std::pair<Real, Real>>{
                 {0.8, 0}, {0.8, 1e-12}, {0.8, -1e-9}, {0.8, 1e-6}, {1.2, 0}, {0.7, 0.02}})
          EXPECT_LT(change_of_gaps(flat_before_wheel(quadratic, facets, width, aside, noise)),
                    1e-9 + 2 * noise)
              << "P" << 1 + quadratic << ", " << facets << " facets, flat of " << width << " at "
              << aside << ", noise " << noise;
}

TEST(MortarMoments, WhatRemovedNodesOfAFlatAreBeforeStaysInTheGap) {
  Surfaces s = flat_before_wheel(false, 8, 0.3, 0.02, 0);
  for (Index i = 0; i < 25; ++i) s.nodes.X[i][0] *= 0.9;  // all of it is before the wheel
  s.nodes.taken.assign(s.nodes.X.size(), 0);
  for (Index i : {0, 1, 2, 3, 4, 12}) s.nodes.taken[i] = 1;  // a side of it, and its middle
  s.options.smooth = false;                                  // what faces the flat is above it
  const Mortar by_wheel = s.mortar();
  s.options.freedom = {};
  const Mortar by_flat = s.mortar();
  ASSERT_EQ(by_wheel.nodes().size(), by_flat.nodes().size());
  Real removed = 0;
  for (std::size_t k = 0; k < by_flat.nodes().size(); ++k) {
    const SlaveNode &at = by_wheel.nodes()[k], &above = by_flat.nodes()[k];
    EXPECT_NEAR(at.distance, at.normal[2] * above.distance, 1e-13);
    removed = std::max(removed, at.weight / above.weight - 1);
  }
  EXPECT_GT(removed, 1e-6);
}

TEST(MortarMoments, TheMeanPointOfTheMasterLiesOnTheNormalOfTheSlave) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (int curved : {1, 2})
        for (int m : {5, 8, 12}) {
          const Surfaces s = pair_on(d, quadratic, curved, 8, m);
          const Mortar mortar = s.mortar();
          for (Index k = 0; k < mortar.relative().rows(); ++k) {
            const Vec3 e = arm(s, mortar, k), n = mortar.nodes()[k].normal;
            EXPECT_LT((e - e.dot(n) * n).norm(), 1e-13) << d << "D P" << 1 + quadratic << " " << m;
          }
        }
}

TEST(MortarMoments, ForcesAndMomentsBalanceOnCurvedUnevenTurnedSurfaces) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (int curved : {0, 1, 2})
        for (bool friction : {false, true}) {
          const Surfaces s = pair_on(d, quadratic, curved, 7, 9);
          const auto [force, moment] = imbalance(s, s.mortar(), friction);
          EXPECT_LT(force, 1e-14);
          EXPECT_LT(moment, 1e-13) << d << "D P" << 1 + quadratic << " " << curved << friction;
        }
}

TEST(MortarMoments, GivenNormalsAreThoseThatTheMasterIsBalancedAbout) {
  Surfaces s = pair_on(3, false, 1, 6, 7);
  const Vec3 centre = turned(3, Vec3(0.5, 0.5, 0));
  for (const Vec3& x : s.nodes.X) s.options.normals.push_back(3 * (centre - x));
  const Mortar mortar = s.mortar();
  for (Index k = 0; k < mortar.relative().rows(); ++k) {
    const SlaveNode& node = mortar.nodes()[k];
    EXPECT_LT((node.normal - s.options.normals[node.node].normalized()).norm(), 1e-15);
    const Vec3 e = arm(s, mortar, k);
    EXPECT_LT((e - e.dot(node.normal) * node.normal).norm(), 1e-13);
  }
}

TEST(MortarMoments, TranslationsOfBothBodiesStayWithoutRelativeDisplacement) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      const Surfaces s = pair_on(d, quadratic, 1, 8, 6);
      const Mortar mortar = s.mortar();
      const Matrix& G = mortar.relative();
      EXPECT_LT((G * Vector::Ones(G.cols())).lpNorm<Eigen::Infinity>(), 1e-14);
    }
}

TEST(MortarMoments, OnFlatFacesWhollyOrPartlyCoveredWithStepsAndRimsNothingChanges) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (Real reach : {1.0, 0.57}) {
        Surfaces s = pair_on(d, quadratic, 0, 6, 5, reach);
        const auto step_down = [&](const Vec3& x) {
          Vec3 y = x - 0.3 * Vec3::Unit(d - 1);
          y[0] = reach + 0.3 * x[0];  // past it a rim
          return turned(d, y);
        };
        for (Facet f : s.sheet(4, 1, step_down, 1).facets) {
          f.outward = turned(d, f.outward);
          if (reach < 1) s.pairs[0].master.facets.push_back(f);
        }
        const Mortar mortar = s.mortar();
        for (Index k = 0; k < mortar.relative().rows(); ++k) {
          const Vec3 e = arm(s, mortar, k), n = mortar.nodes()[k].normal;
          EXPECT_LT((e - e.dot(n) * n).norm(), 2e-15) << "nothing to balance";
        }
      }
}

namespace {

/// The row of a node at (x, 0), whose normal leads down, with 0.7 and 0.3 of what is at (0, -1) and
/// (1, -1): balanced.
Matrix balanced_at(Real x) {
  Matrix P(3, 3), G(1, 3);
  P.insert(0, 1) = 0.7, P.insert(0, 2) = 0.3;
  P.makeCompressed();
  G.insert(0, 0) = 1, G.insert(0, 1) = -0.7, G.insert(0, 2) = -0.3;
  SlaveNode node;
  node.normal = Vec3(0, -1, 0);
  RowChoices undecided;
  return balanced(P, G, {node}, {Vec3(x, 0, 0), Vec3(0, -1, 0), Vec3(1, -1, 0)}, undecided);
}

}  // namespace

TEST(MortarMoments, ARowThatIsBalancedIsGivenBackAsItIs) {
  const Matrix same = balanced_at(0.3);
  EXPECT_EQ(same.coeff(0, 1), 0.7);
  EXPECT_EQ(same.coeff(0, 2), 0.3);
}

TEST(MortarMoments, WeightsChangeByAThirdAtMost) {
  // the normal through the slave's node passes the master at 0.3, 0.4, ...: less and less of the
  // way is made, and no weight changes its sign
  for (Real x : {0.3, 0.4, 0.6, 0.9, 3.0}) {
    const Matrix moved = balanced_at(x);
    EXPECT_NEAR(moved.coeff(0, 2), std::min(x, 0.3 * 1.3), 1e-15) << x;
    EXPECT_NEAR(moved.coeff(0, 1) + moved.coeff(0, 2), 1, 1e-15);
  }
}
