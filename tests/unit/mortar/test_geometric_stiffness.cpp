#include <gtest/gtest.h>

#include "core/assembly/mortar/geometric_stiffness.h"
#include "surfaces.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

/// A bulge before a wider surface that is curved less, both uneven and turned: parts of circles or
/// spheres, or with `cubic` curved ever more, so that no motion lets them slip.
Surfaces bulges(int d, bool quadratic, Real lower, Real cubic = 0, int n = 6) {
  Surfaces s(d, quadratic);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, d == 2 ? Vec3::UnitZ() : Vec3(1, 2, 3).normalized())
          .toRotationMatrix();
  const auto shape = [=](Real size, Real curvature, Real waves) {
    return [=](const Vec3& o) -> Vec3 {
      Vec3 x = Vec3::Zero();
      for (int c = 0; c + 1 < d; ++c)
        x[c] = size * (o[c] - 0.5) + 0.02 * std::sin(waves * (o[0] + 2 * o[1]) + c);
      const Real y = d == 3 ? x[1] : 0, square = curvature * x.squaredNorm();
      x[d - 1] = square / (1 + std::sqrt(1 - curvature * square)) +
                 cubic * (std::pow(x[0], 3) - std::pow(y, 3) + x[0] * y * (1 + y));
      return turn * x;
    };
  };
  s.pairs[0].slave = s.sheet(n, -1, shape(1, 0.5, 9), 2);
  s.pairs[0].master = s.sheet(n + 2, 1, shape(1.6, lower, 7), 1);
  for (auto* side : {&s.pairs[0].slave, &s.pairs[0].master})
    for (Facet& f : side->facets) f.outward = turn * f.outward;
  return s;
}

constexpr Real within = 0.3;  ///< reach of what is pressed: none at the rim

/// Forces of a mortar on its contact nodes: pressed along the normals, and rubbed.
std::vector<Vec3> multipliers(const Surfaces& s, const Mortar& mortar, Real mu = 0.5,
                              Real reach = within) {
  std::vector<Vec3> y;
  for (const SlaveNode& at : mortar.nodes()) {
    const Real k = at.node;
    Vec3 rub(0.6 * std::sin(k), 0.4 * std::cos(3 * k), s.nodes.dimension == 3 ? 0.2 : 0);
    const Real pressed = s.nodes.X[at.node].norm() < reach ? 1 : 0;
    y.push_back(pressed * (-(1 + 0.5 * std::sin(2 * k)) * at.normal +
                           mu * (rub - rub.dot(at.normal) * at.normal)));
  }
  return y;
}

/// G'y, whose y turn with the normals from where they were `before`.
std::vector<Vec3> force(const Mortar& mortar, std::vector<Vec3> y,
                        const std::vector<SlaveNode>& before) {
  std::vector<Vec3> f(mortar.relative().cols(), Vec3::Zero());
  for (Index k = 0; k < mortar.relative().rows(); ++k) {
    const Vec3 &n = before[k].normal, &now = mortar.nodes()[k].normal;
    y[k] += n.cross(now - n).cross(y[k]);
    for (Matrix::InnerIterator G(mortar.relative(), k); G; ++G) f[G.col()] += G.value() * y[k];
  }
  return f;
}

/// The stiffness of the forces at hand.
Mortar loaded(Surfaces s, const std::vector<Vec3>& f) {
  s.options.force = f;
  return s.mortar();
}
NodeBlocks stiffness(const Surfaces& s, const std::vector<Vec3>& f) {
  return loaded(s, f).stiffness().forces;
}

/// Motions of the nodes: each goes its own way, or all bend as one where that is `even`.
std::vector<Vec3> ways(const Surfaces& s, int motion, bool even) {
  std::vector<Vec3> along(s.nodes.X.size(), Vec3::Zero());
  for (std::size_t j = 0; j < along.size(); ++j)
    for (int c = 0; c < s.nodes.dimension; ++c)
      along[j][c] =
          std::sin(motion * (even ? s.nodes.X[j].dot(Vec3(0.4, 0.6, 0.2)) : 7. * j) + 3 * c);
  return along;
}

constexpr Real way_aside = 1e-6;

/// The mortars on both sides, for central differences.
std::pair<Mortar, Mortar> beside(const Surfaces& s, const std::vector<Vec3>& along) {
  Surfaces up = s, down = s;
  for (std::size_t j = 0; j < along.size(); ++j) {
    up.nodes.X[j] += way_aside * along[j];
    down.nodes.X[j] -= way_aside * along[j];
  }
  return {up.mortar(), down.mortar()};
}

/// How far the stiffness is off along motions of the nodes, from central differences.
Real error(const Surfaces& s, const std::vector<std::vector<Vec3>>& motions, Real reach = within) {
  const Mortar mortar = s.mortar();
  const std::vector<Vec3> y = multipliers(s, mortar, 0.5, reach);
  const Mortar sloped = loaded(s, force(mortar, y, mortar.nodes()));
  Real worst = 0;
  for (const std::vector<Vec3>& along : motions) {
    const auto straight = straightened(s.nodes.dimension, s.pairs, along);
    auto off = mortar::change(sloped, along, s.nodes.reference.empty() ? along : straight).force;
    Real size = 0;
    const auto [up, down] = beside(s, along);
    const auto high = force(up, y, mortar.nodes()), low = force(down, y, mortar.nodes());
    for (std::size_t i = 0; i < off.size(); ++i) {
      const Vec3 exact = (high[i] - low[i]) / (2 * way_aside);
      off[i] -= exact;
      size = std::max(size, exact.norm());
    }
    EXPECT_GT(size, 0.1);
    for (const Vec3& f : off) worst = std::max(worst, f.norm() / size);
  }
  return worst;
}

Real error(const Surfaces& s, bool even = false, Real reach = within) {
  return error(s, {ways(s, 1, even), ways(s, 2, even), ways(s, 3, even)}, reach);
}

/// How far the slopes of gaps are off along such a motion, and how large the largest is.
Real error_of_gaps(const Surfaces& s, bool even = false, Real reach = within) {
  const Mortar mortar = s.mortar();
  Surfaces loaded = s;
  loaded.options.force = force(mortar, multipliers(s, mortar, 0.5, reach), mortar.nodes());
  const std::vector<Vec3> along = ways(s, 1, even);
  const auto [high, low] = beside(s, along);
  std::map<Index, Real> slope;
  const Mortar sloped = loaded.mortar();
  for (const auto& [kj, by] : sloped.stiffness().gaps) slope[kj.first] += by.dot(along[kj.second]);
  EXPECT_GT(slope.size(), 2u);
  Real worst = 0, size = 0;
  for (const auto& [k, found] : slope) {
    const Real exact = (high.nodes()[k].gap - low.nodes()[k].gap) / (2 * way_aside);
    worst = std::max(worst, std::abs(found - exact));
    size = std::max(size, std::abs(exact));
  }
  EXPECT_GT(size, even ? 0.005 : 0.1);
  return worst / size;
}

/// The same of edges that bend: how far n.(G x) + g, which Newton's steps see, is off.
Real error_of_bent_gaps(const Surfaces& s, const std::vector<Vec3>& along) {
  const Mortar mortar = s.mortar();
  const Mortar sloped = loaded(s, force(mortar, multipliers(s, mortar), mortar.nodes()));
  const auto straight = straightened(s.nodes.dimension, s.pairs, along);
  const Vector change = mortar::change(sloped, along, straight).gap;
  const auto [high, low] = beside(s, along);
  Real worst = 0, size = 0;
  for (Index k = 0; k < change.size(); ++k) {
    if (change[k] == 0) continue;
    Real seen = 0;
    for (Matrix::InnerIterator G(sloped.relative(), k); G; ++G)
      seen += G.value() * sloped.nodes()[k].normal.dot(along[G.col()]);
    const Real exact = (high.nodes()[k].gap - low.nodes()[k].gap) / (2 * way_aside);
    worst = std::max(worst, std::abs(change[k] - seen - exact));
    size = std::max(size, std::abs(exact));
  }
  EXPECT_GT(size, 0.1);
  return worst / size;
}

/// Normals that stay, those of the mesh.
Surfaces with_given_normals(Surfaces s) {
  const Mortar mortar = s.mortar();
  s.options.normals.assign(s.nodes.X.size(), Vec3::Zero());
  for (const SlaveNode& at : mortar.nodes()) s.options.normals[at.node] = at.normal;
  return s;
}

/// Elements behind the master's facets, by which rows see across what is between the bodies.
Surfaces with_elements(Surfaces s, bool one_body) {
  for (Facet& f : s.pairs[0].master.facets) {
    Vec3 middle = Vec3::Zero();
    for (int v = 0; v < s.nodes.dimension; ++v) middle += s.nodes.X[f.node[v]] / s.nodes.dimension;
    f.behind = static_cast<Index>(s.nodes.X.size());
    f.one_body = one_body;
    s.nodes.X.push_back(middle - 0.3 * f.outward.normalized());
  }
  s.nodes.before = s.nodes.X;
  return s;
}

}  // namespace

TEST(GeometricStiffness, IsTheDerivativeOfContactForcesWhoseNormalsStand) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (Real lower : {0., -0.3})
        EXPECT_LT(error(with_given_normals(bulges(d, quadratic, lower))), 1e-7)
            << d << "D P" << 1 + quadratic << " " << lower;
}

TEST(GeometricStiffness, KnowsHowBentEdgesOfAPathAreSeenAcross) {
  for (int d : {2, 3}) {
    Surfaces s = with_given_normals(with_elements(bulges(d, true, -0.3), false));
    std::vector<Vec3> bending(s.nodes.X.size(), Vec3::Zero());
    for (const auto* side : {&s.pairs[0].slave, &s.pairs[0].master})
      for (const Facet& f : side->facets)
        for (int k = d; k < nodes_of_facet(d, true); ++k)
          bending[f.node[k]] = std::sin(40 * s.nodes.X[f.node[k]][0]) * f.outward.normalized();
    s.nodes.reference = s.nodes.before = s.nodes.X;
    EXPECT_LT(error(s, {bending}), 1e-7) << d;  // straight as yet
    for (std::size_t j = 0; j < bending.size(); ++j) s.nodes.X[j] += 0.005 * bending[j];
    EXPECT_LT(error(s, {bending}), 1e-7) << d;
    EXPECT_LT(error_of_bent_gaps(s, bending), 1e-7) << d;
  }
}

TEST(GeometricStiffness, KnowsThatNormalsTurnIn2DExactly) {
  for (bool quadratic : {false, true})
    for (bool smooth : {false, true}) {
      Surfaces s = bulges(2, quadratic, -0.3, 0.1);
      s.options.smooth = smooth;
      EXPECT_LT(error(s), 1e-7) << "2D P" << 1 + quadratic;
    }
}

TEST(GeometricStiffness, KnowsThatNormalsTurnAtTheEndsOfALineExactly) {
  for (bool quadratic : {false, true})
    for (bool smooth : {false, true})
      for (int n : {2, 3, 6}) {
        Surfaces s = bulges(2, quadratic, -0.3, 0.1, n);
        s.options.smooth = smooth;
        EXPECT_LT(error(s, false, 1), 1e-7) << "P" << 1 + quadratic << ", " << n << " facets";
        EXPECT_LT(error_of_gaps(s, false, 1), 1e-7)
            << "P" << 1 + quadratic << ", " << n << " facets";
      }
}

TEST(GeometricStiffness, KnowsThatNormalsTurnIn3DToFirstOrder) {
  for (bool quadratic : {false, true}) {
    const Real coarse = error(bulges(3, quadratic, -0.3, 0.2), true);
    EXPECT_LT(coarse, 0.05) << "P" << 1 + quadratic;
    EXPECT_LT(error(bulges(3, quadratic, -0.3, 0.2, 12), true), 0.6 * coarse);
  }
}

TEST(GeometricStiffness, KnowsHowGapsOfFacetsChangeBetweenNormalsThatStand) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      Surfaces s = with_given_normals(bulges(d, quadratic, -0.3));
      s.options.smooth = false;
      EXPECT_LT(error_of_gaps(s), 1e-7) << d << "D P" << 1 + quadratic;
    }
}

TEST(GeometricStiffness, KnowsHowGapsOfCurvedSurfacesChangeIn2DExactly) {
  for (bool quadratic : {false, true})
    EXPECT_LT(error_of_gaps(bulges(2, quadratic, -0.3, 0.1)), 1e-7) << "P" << 1 + quadratic;
}

TEST(GeometricStiffness, KnowsHowGapsOfCurvedSurfacesChangeIn3DToFirstOrder) {
  for (bool quadratic : {false, true}) {
    const Real coarse = error_of_gaps(bulges(3, quadratic, -0.3, 0.2), true);
    EXPECT_LT(coarse, 0.05) << "P" << 1 + quadratic;
    EXPECT_LT(error_of_gaps(bulges(3, quadratic, -0.3, 0.2, 12), true), 0.6 * coarse);
  }
}

TEST(GeometricStiffness, KnowsHowWhatIsBarelyCoveredSharesItsMultipliers) {
  for (int d : {2, 3}) {
    const Real covered = 1.5e-3 * 0.25, end = 0.25 - (d == 2 ? covered : covered / 2);
    Surfaces s(d);
    s.options.smooth = false;
    const auto sheet = [d](Real from, Real beyond, Real height) {
      return [=](const Vec3& x) {
        Vec3 y = x;
        if (d == 3) y[1] += beyond * (2 * x[1] - 1);
        y[0] = from + (1 + beyond - from) * x[0];
        y[d - 1] =
            height + 0.02 * y[0] + 0.05 * std::max<Real>(0, y[0] - 0.25) * std::sin(9 * y[0]);
        if (d == 3) y[2] += 3e-4 * x[1] * x[1];  // no profile that lets bodies slip along it
        return y;
      };
    };
    s.pairs[0].slave = s.sheet(4, -1, sheet(0, 0, 1e-3), 2);
    s.pairs[0].master = s.sheet(5, 1, sheet(end, 0.2, 0), 1);
    const Mortar mortar = s.mortar();
    s.options.normals.assign(s.nodes.X.size(), -Vec3::Unit(d - 1));
    s.nodes.before = s.nodes.X;
    s.options.force.assign(s.nodes.X.size(), Vec3::Zero());
    for (Index k = 0; k < mortar.relative().rows(); ++k)
      for (Matrix::InnerIterator G(mortar.relative(), k); G; ++G)
        s.options.force[G.col()][d - 1] += (1 + 0.1 * Real(k)) * G.value();
    // What the sliver is covered by stands still, and so do its nodes.
    std::vector<Vec3> along = ways(s, 1, false);
    for (std::size_t j = 0; j < along.size(); ++j)
      if (s.nodes.X[j][0] <= 0.26) along[j].setZero();
    const Mortar now = s.mortar();
    const auto [high, low] = beside(s, along);
    Vector slope = Vector::Zero(now.relative().rows());
    for (const auto& [kj, by] : now.stiffness().gaps) slope[kj.first] += by.dot(along[kj.second]);
    Index shared = 0;
    for (Index k = 0; k < slope.size(); ++k) {
      const Real x = s.nodes.X[now.nodes()[k].node][0];
      if (x > 0.3) continue;  // the first facet's
      ++shared;
      const Real exact = (high.nodes()[k].gap - low.nodes()[k].gap) / (2 * way_aside);
      EXPECT_NEAR(slope[k], exact, 1e-7) << d << "D " << x;
      EXPECT_GT(std::abs(exact), x > 0.2 ? 0.01 : 0);
    }
    EXPECT_EQ(shared, d == 2 ? 2 : 9);
  }
}

namespace {

/// across: 1, 2: rows see across what is between one body, or two.
void expect_forces_follow(int across) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      Surfaces s = bulges(d, quadratic, -0.3);
      if (across > 0) s = with_elements(s, across == 1);
      const Mortar mortar = s.mortar();
      const auto f = force(mortar, multipliers(s, mortar, d == 2 ? 0.5 : 0), mortar.nodes());
      const Vec3 e(0.3, -0.2, d == 3 ? 0.5 : 0),
          r = d == 2 ? Vec3(Vec3::UnitZ()) : Vec3(0.2, 0.7, -0.4);
      std::vector<Vec3> moved(f.size(), Vec3::Zero()), turned = moved;
      for (const auto& [ij, block] : stiffness(s, f)) {
        moved[ij.first] += block * e;
        turned[ij.first] += block * r.cross(s.nodes.X[ij.second]);
      }
      for (std::size_t i = 0; i < f.size(); ++i) {
        EXPECT_LT(moved[i].norm(), 1e-12);
        EXPECT_LT((turned[i] - r.cross(f[i])).norm(), 1e-12) << d << "D P" << 1 + quadratic;
      }
    }
}

}  // namespace

TEST(GeometricStiffness, ForcesFollowRigidMotions) { expect_forces_follow(0); }

TEST(GeometricStiffness, ForcesThatActAcrossAGapFollowRigidMotions) {
  expect_forces_follow(1);
  expect_forces_follow(2);
}
