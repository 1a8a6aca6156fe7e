#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "core/assembly/slippable.h"
#include "core/assembly/smooth_normals.h"

using namespace frictioncg;

namespace {

using Vec3 = Eigen::Vector3d;
using Map = std::function<Vec3(Real, Real)>;

/// A surface with its true normals.
struct Shape {
  Faceted surface;
  std::vector<Vec3> normal;  ///< at the vertices
};

/// One fan at each vertex, of all facets there.
void add_fans(Faceted& s, bool by_measure = true) {
  s.fans.assign(s.X.size(), Fan());
  for (std::size_t i = 0; i < s.X.size(); ++i) s.fans[i].vertex = static_cast<Index>(i);
  for (std::size_t f = 0; f < s.facets.size(); ++f) {
    const auto& v = s.facets[f].vertex;
    const Vec3 e = s.X[v[1]] - s.X[v[0]];
    const Real measure = s.d == 2 ? e.norm() : e.cross(s.X[v[2]] - s.X[v[0]]).norm();
    for (int k = 0; k < s.d; ++k) {
      s.fans[v[k]].facets.push_back(static_cast<Index>(f));
      s.fans[v[k]].mean += (by_measure ? measure : 1) * s.facets[f].normal;
    }
  }
  for (Fan& fan : s.fans) fan.mean.normalize();
}

/// The curve through x(t), body on its left: t0, t1, ... need not be even.
Shape curve(const std::vector<Real>& t, bool closed, const std::function<Vec3(Real)>& x,
            const std::function<Vec3(Real)>& normal) {
  Shape c;
  c.surface.d = 2;
  const Index n = static_cast<Index>(t.size());
  for (Real at : t) {
    c.surface.X.push_back(x(at));
    c.normal.push_back(normal(at).normalized());
  }
  for (Index i = 0; i < (closed ? n : n - 1); ++i) {
    const Index j = (i + 1) % n;
    const Vec3 e = (c.surface.X[j] - c.surface.X[i]).normalized();
    c.surface.facets.push_back({{i, j, -1}, Vec3(e[1], -e[0], 0)});
  }
  add_fans(c.surface);
  return c;
}

std::vector<Real> uneven(int n, Real from, Real to, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<Real> noise(-0.35, 0.35);
  std::vector<Real> t;
  for (int i = 0; i < n; ++i)
    t.push_back(from + (to - from) * (i + (i > 0 && i + 1 < n ? noise(random) : 0)) / (n - 1));
  return t;
}

/// nx x ny cells of the unit square, moved at random and cut along random diagonals, under a map.
/// moved: vertices may leave the lines u = i/nx.
Shape sheet(int nx, int ny, unsigned seed, const Map& x, const Map& normal, bool moved = true,
            bool closed = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<Real> noise(-0.3, 0.3);
  Shape s;
  s.surface.d = 3;
  const int columns = closed ? nx : nx + 1;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i < columns; ++i) {
      const bool inner_u = closed || (i > 0 && i < nx), inner_v = j > 0 && j < ny;
      const Real u = (i + (inner_u && moved ? noise(random) : 0)) / nx;
      const Real v = (j + (inner_v ? noise(random) : 0)) / ny;
      s.surface.X.push_back(x(u, v));
      s.normal.push_back(normal(u, v).normalized());
    }
  const auto at = [&](int i, int j) { return Index(j * columns + i % columns); };
  const auto add = [&](Index a, Index b, Index c) {
    const auto& X = s.surface.X;
    const Vec3 n = (X[b] - X[a]).cross(X[c] - X[a]).normalized();
    s.surface.facets.push_back({{a, b, c}, n.dot(s.normal[a]) > 0 ? n : Vec3(-n)});
  };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      if (random() % 2) {
        add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
        add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
      } else {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  add_fans(s.surface);
  return s;
}

Real largest_error(const Shape& s) {
  const std::vector<FanNormal> found = smooth_normals(s.surface);
  Real most = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    most = std::max(most, (found[i].normal - s.normal[i]).norm());
  return most;
}

Real error_of_mean(const Shape& s) {
  Real most = 0;
  for (std::size_t i = 0; i < s.normal.size(); ++i)
    most = std::max(most, (s.surface.fans[i].mean - s.normal[i]).norm());
  return most;
}

Vec3 on_circle(Real t) { return Vec3(std::cos(t), std::sin(t), 0); }

/// Orders from meshes of n, 2n and 4n cells, of the worst of several seeds.
Real order(int n, const std::function<Shape(int n, unsigned seed)>& make) {
  Real coarse = 0, fine = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    coarse = std::max(coarse, largest_error(make(n, seed)));
    fine = std::max(fine, largest_error(make(4 * n, seed)));
  }
  return std::log2(coarse / fine) / 2;
}

Shape cylinder(int nx, int ny, unsigned seed, bool moved, Real angle = 1.5, Real length = 1) {
  const auto normal = [=](Real u, Real) { return on_circle(angle * u); };
  return sheet(
      nx, ny, seed, [=](Real u, Real v) { return Vec3(normal(u, v) + length * v * Vec3::UnitZ()); },
      normal, moved);
}

}  // namespace

TEST(SmoothNormals, AreExactOnACircleWhateverTheSpacingAndAtItsEnds) {
  for (unsigned seed : {1, 2, 3}) {
    std::vector<Real> t = uneven(41, 0, 2 * M_PI, seed);
    t.pop_back();
    const Shape circle = curve(t, true, on_circle, on_circle);
    EXPECT_GT(error_of_mean(circle), 1e-2);
    EXPECT_LT(largest_error(circle), 1e-13);
    EXPECT_LT(largest_error(curve(uneven(8, 0, 1, seed), false, on_circle, on_circle)), 1e-13);
  }
}

TEST(SmoothNormals, AreExactOnCylindersAndSpheresWhateverTheTriangulationAndAtRims) {
  const auto sphere = [](Real u, Real v) {
    return Vec3(std::cos(1.2 * u) * std::cos(v), std::sin(1.2 * u) * std::cos(v), std::sin(v));
  };
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (bool moved : {false, true}) {
      EXPECT_GT(error_of_mean(cylinder(8, 5, seed, moved)), 1e-2);
      EXPECT_LT(largest_error(cylinder(8, 5, seed, moved)), 1e-12) << seed << moved;
      EXPECT_LT(largest_error(sheet(8, 6, seed, sphere, sphere, moved)), 1e-12) << seed << moved;
    }
}

TEST(SmoothNormals, AreExactOnACylinderOfOneLayerOfElements) {
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (Real length : {0.05, 0.2, 1.0, 3.0, 6.0})
      EXPECT_LT(largest_error(cylinder(8, 1, seed, true, 1.5, length)), 1e-12) << seed << length;
}

TEST(SmoothNormals, OfAConeOfOneLayerAreNotThoseOfABall) {
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (Real slope : {0.05, 0.15, 0.4, 0.6, 1.0}) {
      const auto at = [&](Real u, Real v) {
        const Real r = 1 + slope * v;
        return Vec3(r * std::cos(2 * u), r * std::sin(2 * u), v);
      };
      const auto normal = [&](Real u, Real) {
        return Vec3(Vec3(std::cos(2 * u), std::sin(2 * u), -slope).normalized());
      };
      EXPECT_LT(largest_error(sheet(8, 1, seed, at, normal, false)), 0.1) << seed << slope;
    }
}

TEST(SmoothNormals, AreOfSecondOrderOnAnEllipse) {
  const auto ellipse = [](int n, unsigned seed) {
    std::vector<Real> t = uneven(n + 1, 0, 2 * M_PI, seed);
    t.pop_back();
    return curve(
        t, true, [](Real s) { return Vec3(2 * std::cos(s), std::sin(s), 0); },
        [](Real s) { return Vec3(std::cos(s), 2 * std::sin(s), 0); });
  };
  EXPECT_GT(order(80, ellipse), 1.8);
  EXPECT_LT(largest_error(ellipse(320, 1)), 2e-3);
}

TEST(SmoothNormals, AreOfSecondOrderOnATorusAndOnAFreeFormRimsIncluded) {
  const auto torus = [](int n, unsigned seed) {
    const auto normal = [](Real u, Real v) {
      const Real p = 2 * u, q = 2 * v;
      return Vec3(std::cos(p) * std::cos(q), std::sin(p) * std::cos(q), std::sin(q));
    };
    return sheet(
        n, n / 2, seed, [=](Real u, Real v) { return Vec3(2 * on_circle(2 * u) + normal(u, v)); },
        normal);
  };
  EXPECT_GT(order(12, torus), 1.8);
  const auto free_form = [](int n, unsigned seed) {
    return sheet(
        n, n, seed,
        [](Real u, Real v) {
          return Vec3(u, v, 0.2 * std::sin(3 * u) * std::cos(2 * v) + u * v * v / 4);
        },
        [](Real u, Real v) {
          return Vec3(-0.6 * std::cos(3 * u) * std::cos(2 * v) - v * v / 4,
                      0.4 * std::sin(3 * u) * std::sin(2 * v) - u * v / 2, 1);
        });
  };
  EXPECT_GT(order(10, free_form), 1.8);
}

TEST(SmoothNormals, AreTheMeanBitByBitOnFlatFaces) {
  const Vec3 n = Vec3(0.3, -0.5, 0.7).normalized(), s = n.cross(Vec3::UnitX()).normalized();
  const Shape plane = sheet(
      6, 5, 3, [=](Real u, Real v) { return Vec3(u * s + v * n.cross(s)); },
      [=](Real, Real) { return n; });
  const std::vector<FanNormal> found = smooth_normals(plane.surface);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].normal, plane.surface.fans[i].mean);
    EXPECT_EQ(found[i].turn, 0);
  }
}

namespace {

/// A flat face along x up to 0, then a fillet of radius 1; s: length along the profile.
Vec3 profile(Real s) { return s < 0 ? Vec3(s, 0, 0) : Vec3(std::sin(s), 1 - std::cos(s), 0); }
Vec3 outward(Real s) { return s < 0 ? Vec3(0, -1, 0) : Vec3(std::sin(s), -std::cos(s), 0); }

}  // namespace

TEST(SmoothNormals, AreExactWhereAFlatFaceMeetsAFillet) {
  for (unsigned seed : {1, 2, 3}) {
    std::vector<Real> s = uneven(7, -1, 0, seed), arc = uneven(9, 0, 1.4, seed + 10);
    s.insert(s.end(), arc.begin() + 1, arc.end());
    const Shape joint = curve(s, false, profile, outward);
    EXPECT_GT(error_of_mean(joint), 1e-2);
    EXPECT_LT(largest_error(joint), 1e-13) << seed;
    const std::vector<FanNormal> found = smooth_normals(joint.surface);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(found[i].normal, joint.surface.fans[i].mean);
  }
}

TEST(SmoothNormals, AreThoseOfTheArcsWhereTwoMeetTangentially) {
  const auto x = [](Real s) {
    return s < 0 ? Vec3(3 * std::sin(s / 3), 3 - 3 * std::cos(s / 3), 0) : profile(s);
  };
  const auto n = [](Real s) {
    return s < 0 ? Vec3(std::sin(s / 3), -std::cos(s / 3), 0) : outward(s);
  };
  std::vector<Real> s = uneven(7, -1, 0, 5), arc = uneven(9, 0, 1.4, 6);
  s.insert(s.end(), arc.begin() + 1, arc.end());
  EXPECT_LT(largest_error(curve(s, false, x, n)), 1e-13);
}

TEST(SmoothNormals, AreThoseOfASideWhereAFlatFaceMeetsAFilletIn3D) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const auto s = [](Real u) { return u < 0.5 ? 2 * u - 1 : 2.4 * (u - 0.5); };
    const Shape joint = sheet(
        12, 8, seed, [&](Real u, Real v) { return Vec3(profile(s(u)) + 1.3 * v * Vec3::UnitZ()); },
        [&](Real u, Real) { return outward(s(u)); }, false);
    EXPECT_GT(error_of_mean(joint), 1e-2);
    int off = 0;  // a few see no side that is smooth
    const std::vector<FanNormal> found = smooth_normals(joint.surface);
    for (std::size_t i = 0; i < found.size(); ++i)
      off += (found[i].normal - joint.normal[i]).norm() > 1e-8;
    EXPECT_LE(off, 1) << seed;
  }
}

TEST(SmoothNormals, AreTheBisectorAtALoneKink) {
  const Real half = 10 * M_PI / 180;
  const auto x = [=](Real s) { return Vec3(s * std::cos(half), std::abs(s) * std::sin(half), 0); };
  const Shape kink = curve({-3, -2, -1, 0, 0.3, 0.6, 0.9}, false, x, [=](Real s) {
    return s == 0 ? Vec3(0, -1, 0) : Vec3((s < 0 ? -1 : 1) * std::sin(half), -std::cos(half), 0);
  });
  EXPECT_LT(largest_error(kink), 1e-15);
}

TEST(SmoothNormals, OfASurfaceThatMovesDoNotJump) {
  // between two random sheets of bumps, to the point where some normal changes fastest
  const auto sheet_at = [](Real s) {
    const auto x = [=](Real u, Real v) {
      return Vec3(u, v, 0.03 * std::sin(9 * u + 2 * s) * std::cos(7 * v - 3 * s) + 0.1 * s * u * u);
    };
    return sheet(6, 6, 3, x, [](Real, Real) { return Vec3::UnitZ(); }).surface;
  };
  const auto apart = [&](Real from, Real to) {
    const std::vector<FanNormal> a = smooth_normals(sheet_at(from)),
                                 b = smooth_normals(sheet_at(to));
    Real most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      most = std::max(most, (a[i].normal - b[i].normal).norm());
    return most;
  };
  for (int k = 0; k < 10; ++k) {
    Real from = 0.1 * k, to = from + 0.1;
    while (to - from > 1e-12) {
      const Real middle = (from + to) / 2;
      (apart(from, middle) > apart(middle, to) ? to : from) = middle;
    }
    EXPECT_LT(apart(from, to), 1e-7) << from;
  }
}

TEST(SmoothNormals, AreTheBisectorAtAKinkBetweenTwoArcsOfOneRadius) {
  const Real half = 10 * M_PI / 180;
  const auto tangent = [=](Real s) { return s + (s < 0 ? -half : half); };
  const auto x = [=](Real s) {
    const Real from = s < 0 ? -half : half, to = tangent(s);
    return Vec3(std::sin(to) - std::sin(from), std::cos(from) - std::cos(to), 0);
  };
  const auto n = [=](Real s) {
    return s == 0 ? Vec3(0, -1, 0) : Vec3(std::sin(tangent(s)), -std::cos(tangent(s)), 0);
  };
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::vector<Real> s = uneven(8, -1, 0, seed), right = uneven(9, 0, 1, seed + 20);
    s.insert(s.end(), right.begin() + 1, right.end());
    const Shape kink = curve(s, false, x, n);
    EXPECT_LT((smooth_normals(kink.surface)[7].normal - n(0)).norm(), 1e-12) << seed;
  }
}

TEST(SmoothNormals, AreTheMeanBitByBitWhereAllFacetsAreFlatBesideAFillet) {
  const auto s = [](Real u) { return u < 0.5 ? 2 * u - 1 : 2.4 * (u - 0.5); };
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Shape joint = sheet(
        12, 8, seed, [&](Real u, Real v) { return Vec3(profile(s(u)) + 1.3 * v * Vec3::UnitZ()); },
        [&](Real u, Real) { return outward(s(u)); }, false);
    const std::vector<FanNormal> found = smooth_normals(joint.surface);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (i % 13 > 5) continue;  // from the joint on
      EXPECT_EQ(found[i].normal, joint.surface.fans[i].mean) << i;
      EXPECT_EQ(found[i].turn, 0) << i;
    }
  }
}

TEST(SmoothNormals, DoNotLookAcrossARidgeBetweenFans) {
  // a half cylinder on a plane at a right angle, fans apart at the ridge
  std::vector<Real> s = uneven(6, -1, 0, 1), arc = uneven(8, 0, 1.3, 2);
  s.insert(s.end(), arc.begin() + 1, arc.end());
  const auto x = [](Real t) {
    return t < 0 ? Vec3(-1, t, 0) : Vec3(-std::cos(t), std::sin(t), 0) + Vec3(0, 0, 0);
  };
  Shape shape = curve(s, false, x, [](Real t) { return t < 0 ? Vec3(-1, 0, 0) : on_circle(t); });
  std::vector<Fan> fans;
  for (Fan fan : shape.surface.fans) {
    if (fan.vertex != 5) {
      fans.push_back(fan);
      continue;
    }
    for (Index f : fan.facets) fans.push_back({5, {f}, shape.surface.facets[f].normal});
  }
  shape.surface.fans = fans;
  const std::vector<FanNormal> found = smooth_normals(shape.surface);
  for (std::size_t p = 0; p < fans.size(); ++p) {
    const Vec3& at = shape.surface.X[fans[p].vertex];
    const Vec3 expected = p <= 5 ? fans[0].mean : Vec3(-at);
    const Real sign = found[p].normal.dot(expected) < 0 ? -1 : 1;
    EXPECT_LT((found[p].normal - sign * expected).norm(), 1e-13) << p;
    EXPECT_EQ(found[p].turn == 0, p <= 5) << p;
  }
}

TEST(OsculatingQuadric, IsNoneWhereItLeansFromTheMeanNormal) {
  const std::vector<Vec3> along = {Vec3(0.05, 1, 0), Vec3(0.1, 2.1, 0)};
  EXPECT_FALSE(osculating_quadric(2, along, Vec3::UnitY()));
  EXPECT_TRUE(osculating_quadric(2, along, Vec3::UnitX()));
}

TEST(OsculatingQuadric, IsAPlaneWhereNoPointTellsMore) {
  for (Real t : {0.1, 0.3, 0.7}) {
    EXPECT_EQ(osculating_quadric(2, {Vec3(t / 3, 1, 0)}, Vec3::UnitX())->curvature.norm(), 0);
    const std::vector<Vec3> two = {Vec3(1, t / 3, t / 7), Vec3(t / 5, 1, -t / 9)};
    EXPECT_EQ(osculating_quadric(3, two, Vec3::UnitZ())->curvature.norm(), 0);
  }
}

TEST(OsculatingQuadric, OfASaddleIsItsTwistWhereNoCurvatureMakesItDevelopable) {
  // on two lines that cross, x^2 and y^2 are one
  for (Real turn : {0.1, 0.2, 0.3, 0.5}) {
    const Vec3 a(std::cos(turn), std::sin(turn), 0.1), b(-std::sin(turn), std::cos(turn), -0.1);
    const std::vector<Vec3> around = {a, Vec3(-a[0], -a[1], 0.1), b, Vec3(-b[0], -b[1], -0.1)};
    const Vec3 lines = osculating_quadric(3, around, Vec3::UnitZ())->curvature * a;
    EXPECT_LT((lines - 0.2 / 1.01 * Vec3(a[0], a[1], 0)).norm(), 1e-2) << turn;
  }
}

TEST(OsculatingQuadric, OfASurfaceThatMovesGoesOverIntoOneThatItsVerticesLeaveOpen) {
  // five vertices on two lines, but for the last, which leaves them: what it tells of the curvature
  // across is rounding at first
  const auto at = [](Real off, bool moves) {
    const std::vector<Vec3> around = {Vec3(1, 0, 0.1), Vec3(2, 0, 0.4), Vec3(0, 1, 0.05),
                                      Vec3(1, 1, 0.2), Vec3(2, 1 + off, 0.6)};
    return osculating_quadric(3, around, Vec3::UnitZ(), {moves})->normal;
  };
  constexpr Real step = 1e-3;
  Real most = 0, jumps = 0;
  for (Real off = step; off < 1; off += step) {
    most = std::max(most, (at(off, true) - at(off - step, true)).norm());
    jumps = std::max(jumps, (at(off, false) - at(off - step, false)).norm());
  }
  EXPECT_GT(jumps, 0.01);
  EXPECT_LT(most, 0.1 * jumps);
  const std::vector<Vec3> all = {Vec3(1, 0, -0.5),  Vec3(-1, 0, -0.5),     Vec3(0, 1, -0.5),
                                 Vec3(0, -1, -0.5), Vec3(0.7, 0.7, -0.49), Vec3(-0.7, 0.7, -0.49)};
  const Quadric moved = *osculating_quadric(3, all, Vec3::UnitZ(), {true}),
                rests = *osculating_quadric(3, all, Vec3::UnitZ());
  EXPECT_LT((moved.normal - rests.normal).norm(), 1e-14);
  EXPECT_LT((moved.curvature - rests.curvature).norm(), 1e-13 * rests.curvature.norm());
}

TEST(SmoothNormals, OfCancellingFacetsAreNone) {
  Faceted s;
  s.X = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1e-3, 0)};
  s.facets = {{{0, 1, -1}, Vec3(0, -1, 0)}, {{2, 0, -1}, Vec3(0, 1, 0)}};
  s.fans = {{0, {0, 1}, Vec3::Zero()}};
  EXPECT_EQ(smooth_normals(s)[0].normal, Vec3::Zero());
}

TEST(SmoothNormals, InTheMiddleOfAnEdgeAreThoseOfTheArc) {
  const Vec3 a = on_circle(0.2) + Vec3(0, 0, 0.1), b = on_circle(0.5) + Vec3(0, 0, 0.7);
  const Vec3 n_a = on_circle(0.2), n_b = on_circle(0.5), middle = on_circle(0.35);
  EXPECT_LT((arc_normal(n_a, n_b, b - a, n_a) - middle).norm(), 1e-15);
  EXPECT_EQ(arc_normal(n_a, n_a, Vec3(0, 0, 1e-3), n_a), n_a);
}

TEST(SmoothNormals, InTheMiddleOfAnEdgeAreTheMeanWhereTheEndsHaveItOrTheEdgeLeavesNothing) {
  std::mt19937 random(1);
  std::uniform_real_distribution<Real> any(-1, 1);
  for (int k = 0; k < 50; ++k) {
    const Vec3 n = Vec3(any(random), any(random), any(random)).normalized();
    EXPECT_EQ(arc_normal(n, n, Vec3(0.3 * n.cross(Vec3(1, 2, 3))), n), n);
  }
  const Vec3 along = Vec3::UnitX(), mean = Vec3::UnitY();
  EXPECT_EQ(arc_normal(along, along, along, mean), mean);
}

namespace {

/// The points of an uneven circle of n vertices, each off by `error` at random, all round.
std::vector<PointNormal> points(const Shape& s) {
  std::vector<PointNormal> all;
  const std::vector<FanNormal> found = smooth_normals(s.surface);
  for (std::size_t i = 0; i < found.size(); ++i)
    all.push_back({s.surface.X[s.surface.fans[i].vertex], found[i].normal,
                   static_cast<Real>(s.surface.fans[i].facets.size()), found[i].turn});
  return all;
}

Shape oval(int n, Real ovality, Real error) {
  std::mt19937 random(7);
  std::uniform_real_distribution<Real> noise(-1, 1);
  std::vector<Real> t = uneven(n + 1, 0, 2 * M_PI, 3);
  t.pop_back();
  return curve(
      t, true,
      [&](Real s) {
        const Real r = 20 + 20 * ovality * std::cos(2 * s) + error * noise(random);
        return Vec3(r * on_circle(s) + Vec3(3, 1, 0));
      },
      on_circle);
}

Real wedge(const std::vector<PointNormal>& all, const Vec3& centre) {
  Real most = 0;
  for (const PointNormal& p : all) {
    const Vec3 w = Vec3::UnitZ().cross(p.x - centre);
    most = std::max(most, std::abs(p.normal.dot(w)) / w.norm());
  }
  return most;
}

}  // namespace

TEST(SlippableMotions, OfACircleAsFarAsItsVerticesTellIsFollowedToRounding) {
  for (Real error : {0.0, 1e-5, 1e-3}) {
    std::vector<PointNormal> all = points(oval(80, 0, error));
    EXPECT_EQ(follow_slippable_motions(2, all), 1);
    EXPECT_LT(wedge(all, Vec3(3, 1, 0)), error / 4 + 1e-14);
    // about a centre of its own
    Eigen::MatrixXd lines(all.size(), 2);
    Eigen::VectorXd right(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Vec3& n = all[i].normal;
      lines.row(static_cast<Index>(i)) << -n[1], n[0];
      right[static_cast<Index>(i)] = n[0] * all[i].x[1] - n[1] * all[i].x[0];
    }
    const Eigen::VectorXd centre = lines.colPivHouseholderQr().solve(right);
    EXPECT_LT(wedge(all, Vec3(centre[0], centre[1], 0)), 1e-14) << error;
  }
}

TEST(SlippableMotions, OfAnOvalAreNone) {
  std::vector<PointNormal> all = points(oval(80, 0.03, 0));
  const std::vector<PointNormal> before = all;
  EXPECT_EQ(follow_slippable_motions(2, all), 0);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].normal, before[i].normal);
}

TEST(SlippableMotions, OfASphereAreThreeAndOfACylinderTwo) {
  std::vector<PointNormal> tube = points(cylinder(24, 5, 1, true, 6));
  EXPECT_EQ(follow_slippable_motions(3, tube), 2);
  EXPECT_LT(wedge(tube, Vec3::Zero()), 1e-14);
  for (const PointNormal& p : tube) EXPECT_LT(std::abs(p.normal[2]), 1e-14);
  const auto sphere = [](Real u, Real v) {
    return Vec3(on_circle(3 * u) * std::cos(1.2 * v) + std::sin(1.2 * v) * Vec3::UnitZ());
  };
  std::vector<PointNormal> ball = points(sheet(16, 8, 2, sphere, sphere));
  EXPECT_EQ(follow_slippable_motions(3, ball), 3);
}

TEST(SlippableMotions, OfAConeAreRotationsAndOfAThreadScrews) {
  // r = 1 + v/2, raised by `pitch` a radian; all cells are cut alike
  for (Real pitch : {0.0, 0.2}) {
    const auto x = [=](Real u, Real v) {
      return Vec3((1 + v / 2) * on_circle(6 * u) + (v + 6 * pitch * u) * Vec3::UnitZ());
    };
    const auto normal = [=](Real u, Real v) {
      const Vec3 r = on_circle(6 * u);
      return Vec3(((1 + v / 2) * Vec3::UnitZ().cross(r) + pitch * Vec3::UnitZ())
                      .cross(r / 2 + Vec3::UnitZ()));
    };
    std::vector<PointNormal> all = points(sheet(24, 6, 1, x, normal, false));
    Real error = 0;
    EXPECT_EQ(follow_slippable_motions(3, all), 1);
    for (const PointNormal& p : all) {
      const Vec3 w = Vec3::UnitZ().cross(p.x) + pitch * Vec3::UnitZ();
      error = std::max(error, std::abs(p.normal.dot(w)) / w.norm());
    }
    EXPECT_LT(error, pitch == 0 ? 1e-3 : 3e-3);
    if (pitch > 0) continue;
    // the one motion that no normal resists
    DenseMatrix rows(all.size(), 6);
    for (std::size_t i = 0; i < all.size(); ++i)
      rows.row(Index(i)) << all[i].normal.transpose(), all[i].x.cross(all[i].normal).transpose();
    const DenseMatrix slips = null_space(rows, 1e-10);
    ASSERT_EQ(slips.cols(), 1);
    EXPECT_LT(std::abs(slips.col(0).head<3>().dot(slips.col(0).tail<3>())), 1e-12);
  }
}

TEST(SlippableMotions, AreThoseThatAreLeftFreeWhereTheseAreScrewsAlone) {
  std::vector<PointNormal> tube = points(cylinder(24, 5, 1, true, 6));
  const RigidGenerators generators(3, Vec3(0, 0, 0.5), 1);
  Vector screw = generators.about(Vec3::Zero(), 5);
  screw[2] = 0.01;
  EXPECT_EQ(follow_slippable_motions(3, tube), 2);
  tube[3].normal = (tube[3].normal + 1e-4 * Vec3::UnitZ()).normalized();
  EXPECT_EQ(follow_free_motions(3, generators, screw, tube), 1);
  for (const PointNormal& p : tube)
    EXPECT_LT(std::abs(p.normal.dot(generators.at(p.x) * screw)), 1e-14);
}

TEST(SlippableMotions, AreRotationsAsItWasDecided) {
  const auto x = [](Real u, Real v) {
    return Vec3((1 + v / 2) * on_circle(6 * u) + v * Vec3::UnitZ());
  };
  const auto normal = [](Real u, Real) { return Vec3(on_circle(6 * u) - 0.5 * Vec3::UnitZ()); };
  const std::vector<PointNormal> cone = points(sheet(24, 6, 1, x, normal, false));
  const auto rotate = [&](DecidedSlips decided, Real turn) {
    std::vector<PointNormal> all = cone;
    for (PointNormal& p : all) p.turn = turn;
    const Slips found = follow_slippable_motions(3, all, decided);
    EXPECT_EQ(found.count, 1);
    return found.rotations;
  };
  EXPECT_TRUE(rotate({}, 0.2));
  for (bool rotations : {false, true})
    for (Real turn : {0.2, 0.03}) EXPECT_EQ(rotate(Slips{1, rotations}, turn), rotations) << turn;
}

TEST(SlippableMotions, AreNoMoreThanThereAreWhereThoseOfTwoBodiesDependOnEachOther) {
  // a body and what it touches, both free in every way: 12 columns in a space of 6
  std::vector<PointNormal> tube = points(cylinder(24, 5, 1, true, 6));
  const RigidGenerators generators(3, Vec3(0, 0, 0.5), 1);
  DenseMatrix both(6, 12);
  both << DenseMatrix::Identity(6, 6), -DenseMatrix::Identity(6, 6);
  EXPECT_EQ(follow_free_motions(3, generators, both, tube), 2);
  EXPECT_EQ(follow_free_motions(3, generators, both.leftCols(9), tube), 2);
  EXPECT_LT(wedge(tube, Vec3::Zero()), 1e-15);
}

TEST(SlippableMotions, OfPointsOnALineAreThoseThatMoveThem) {
  std::vector<PointNormal> line;
  for (int k = 0; k <= 10; ++k) line.push_back({Vec3(0, 0, k / 10.), Vec3::UnitX(), 1, 0.1});
  EXPECT_GE(follow_slippable_motions(3, line), 1);
}

TEST(SlippableMotions, ThatSupportsLeaveFreeAreThoseOfTheSupports) {
  // a tube whose axis the vertices tell with a tilt, about which supports do not let it turn
  std::mt19937 random(7);
  std::uniform_real_distribution<Real> noise(-1e-3, 1e-3);
  Shape tube_shape = cylinder(24, 5, 1, true, 6);
  for (Vec3& x : tube_shape.surface.X) x.head<2>() *= 1 + noise(random) * (1 + x[2]);
  std::vector<PointNormal> tube = points(tube_shape);
  EXPECT_EQ(follow_slippable_motions(3, tube), 2);
  EXPECT_GT(wedge(tube, Vec3::Zero()), 1e-6);
  const Vec3 pivot(0, 0, 5);
  const RigidGenerators generators(3, Vec3(0.3, -0.2, 1), 2);
  const std::vector<PointNormal> told = tube;
  EXPECT_EQ(follow_free_motions(3, generators, DenseMatrix(6, 0), tube), 0);
  EXPECT_EQ(tube[7].normal, told[7].normal);
  EXPECT_EQ(follow_free_motions(3, generators, generators.about(pivot, 0), tube), 0);
  EXPECT_EQ(tube[7].normal, told[7].normal);
  EXPECT_EQ(follow_free_motions(3, generators, generators.about(pivot, 5), tube), 1);
  EXPECT_LT(wedge(tube, Vec3::Zero()), 1e-15);
  DenseMatrix both(6, 2);
  both << generators.about(pivot, 5), generators.about(pivot, 2);
  EXPECT_EQ(follow_free_motions(3, generators, both, tube), 2);
  EXPECT_LT(wedge(tube, Vec3::Zero()), 1e-15);
  for (const PointNormal& p : tube) EXPECT_LT(std::abs(p.normal[2]), 1e-15);
}

TEST(SlippableMotions, ThatSupportsLeaveFreeAreFollowedCloseToTheirAxis) {
  const RigidGenerators generators(3, Vec3::Zero(), 1);
  std::vector<PointNormal> cap;  // a pole, and what surrounds it: it tells no axis by itself
  for (int k = 0; k < 40; ++k) {
    const Vec3 out = on_circle(0.4 * k);
    cap.push_back({out - 0.4 * Vec3::UnitZ(), (out + Vec3::UnitZ()).normalized(), 1, 0.2});
  }
  const Vec3 near = Vec3(1e-3, 2e-3, 0);
  cap.push_back({near, Vec3(0.02, -0.01, 1).normalized(), 1e-3, 0.2});
  cap.push_back({Vec3::Zero(), Vec3(0.02, -0.01, 1).normalized(), 1e-3, 0.2});
  const Vec3 at_pole = cap.back().normal;
  EXPECT_EQ(follow_free_motions(3, generators, generators.about(Vec3::Zero(), 5), cap), 1);
  EXPECT_LT(std::abs(cap[40].normal.dot(Vec3::UnitZ().cross(near))), 1e-18);
  EXPECT_LT((cap.back().normal - at_pole).norm(), 1e-15);
}

TEST(SlippableMotions, AboutAPivotAreThoseOfTheGenerators) {
  const Vec3 centre(1, 2, 3), pivot(-2, 0.5, 1), x(4, -1, 0.3);
  const RigidGenerators in_3d(3, centre, 2), in_2d(2, Vec3(1, 2, 0), 2);
  for (int c = 0; c < 3; ++c) {
    const Vec3 e = Vec3::Unit(c);
    EXPECT_LT((in_3d.at(x) * in_3d.about(pivot, c) - e).norm(), 1e-15);
    EXPECT_LT((in_3d.at(x) * in_3d.about(pivot, 3 + c) - e.cross(x - pivot) / 2).norm(), 1e-15);
  }
  const Vec3 turned = in_2d.at(x) * in_2d.about(pivot, 2);
  EXPECT_LT((turned - Vec3(-(x - pivot)[1], (x - pivot)[0], 0) / 2).norm(), 1e-15);
}

TEST(SlippableMotions, LeaveFlatPointsAloneBitByBit) {
  std::vector<PointNormal> all = points(oval(80, 0, 1e-4));
  const Vec3 n = Vec3(0.6, 0.8 + 1e-9, 0).normalized();
  all.push_back({Vec3(3, 1, 0) + 30 * n, n, 1, 0});
  EXPECT_EQ(follow_slippable_motions(2, all), 1);
  EXPECT_EQ(all.back().normal, n);
}

TEST(SlippableMotions, LeavePointsAloneThatTheyDoNotMove) {
  std::vector<PointNormal> all;
  for (int k = 0; k < 40; ++k) {
    const Vec3 out = on_circle(0.3 * k);
    all.push_back({out + 0.01 * k * Vec3::UnitZ(), out, 1, 0.2});
    all.push_back({1.5 * out, (out + Vec3::UnitZ()).normalized(), 1, 0.2});
  }
  const Vec3 on_axis = Vec3(0.01, 0.02, 1).normalized();
  all.push_back({Vec3(0, 0, 1), on_axis, 1e-9, 0.2});
  EXPECT_EQ(follow_slippable_motions(3, all), 1);
  EXPECT_LT((all.back().normal - on_axis).norm(), 1e-15);
}

TEST(SlippableMotions, LeaveNormalsAloneThatTheyFollow) {
  std::vector<PointNormal> tube = points(cylinder(24, 5, 1, true, 6));
  const Vec3 n = Vec3(0.1, 0, 1).normalized();  // of an end, on a little facet
  tube.push_back({on_circle(1), n, 1e-9, 0.2});
  EXPECT_EQ(follow_slippable_motions(3, tube), 2);
  EXPECT_EQ(tube.back().normal, n);
}

TEST(SlippableMotions, OfPointsOnALineAreFollowed) {
  const Vec3 along = Vec3::UnitZ(), across = Vec3::UnitX();
  std::vector<PointNormal> line;
  for (int k = 0; k < 9; ++k)
    line.push_back({k * along, (across + (k % 2 ? 1e-4 : -1e-4) * along).normalized(), 1, 0.2});
  EXPECT_GE(follow_slippable_motions(3, line), 1);
  for (const PointNormal& p : line)  // a translation along the line, or next to it
    EXPECT_LT(std::abs((p.normal - line[0].normal).dot(along)), 1e-12);
}

TEST(SlippableMotions, OfPartsOnSeveralProcessesAreThoseOfTheWhole) {
  const std::vector<PointNormal> whole = points(oval(60, 0, 1e-4));
  std::vector<PointNormal> expected = whole;
  ASSERT_EQ(follow_slippable_motions(2, expected), 1);
  std::vector<PointNormal> first(whole.begin(), whole.begin() + 25),
      rest(whole.begin() + 25, whole.end());
  // the sums of the other part, call by call, as its own run makes them
  std::vector<std::vector<Real>> sums;
  std::vector<PointNormal> copy = whole;
  follow_slippable_motions(2, copy, {}, [&](Real* v, Index n) { sums.emplace_back(v, v + n); });
  std::size_t call = 0;
  follow_slippable_motions(2, first, {}, [&](Real* v, Index n) {
    std::copy(sums[call].begin(), sums[call].end(), v);
    ++call;
    EXPECT_LE(call, sums.size());
    EXPECT_EQ(sums[call - 1].size(), static_cast<std::size_t>(n));
  });
  EXPECT_EQ(call, 3u);
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_LT((first[i].normal - expected[i].normal).norm(), 1e-14);
}
