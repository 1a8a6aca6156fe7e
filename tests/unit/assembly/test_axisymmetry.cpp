#include <gtest/gtest.h>

#include "core/assembly/axisymmetry.h"
#include "unit/mortar/bodies.h"

using namespace frictioncg;
using namespace frictioncg::mortar::test;

namespace {

/// The stiffness of a plane body with what a test adds to it, as triplets.
struct Assembled {
  MeshedBodies bodies;
  std::vector<Index> i, j, node;
  std::vector<Real> a;

  explicit Assembled(bool quadratic, bool half = false) : half_(half) {
    bodies.quadratic = quadratic;
    bodies.add_box({6, 5, 0}, [](const Vec3& x) { return Vec3(x); });
    const Matrix A = bodies.stiffness();
    for (Index r = 0; r < A.rows(); ++r) {
      node.push_back(r / 2);
      for (Matrix::InnerIterator it(A, r); it; ++it) add(r, it.col(), it.value());
    }
  }
  void add(Index r, Index c, Real value) {
    if (half_ && c > r) return;
    i.push_back(r), j.push_back(c), a.push_back(value);
  }
  /// A bed of springs along component c
  void add_bed(int c, Real stiffness) {
    for (Index n = 0; n < bodies.nodes(); ++n) add(2 * n + c, 2 * n + c, stiffness);
  }
  /// Rings around an axis across component c, as they strain and press
  void add_rings(int c, Real stiffness) {
    add_bed(c, stiffness);
    for (Index n = 0; n < bodies.nodes(); ++n)
      for (int end : {0, 1}) {
        if (bodies.X[n][1 - c] != end) continue;
        add(2 * n, 2 * n + 1, (2 * end - 1) * stiffness);
        add(2 * n + 1, 2 * n, (2 * end - 1) * stiffness);
      }
  }
  int radius() const {
    return radial_component({Index(node.size()), a.size(), i.data(), j.data(), a.data(), 0, half_},
                            node);
  }

 private:
  bool half_;
};

}  // namespace

TEST(Axisymmetry, RingsAreSeenAlongTheirRadiusEvenFarFromTheAxis) {
  for (bool quadratic : {false, true})
    for (bool half : {false, true})
      for (int c : {0, 1})
        for (Real stiffness : {1.0, 1e-8}) {
          Assembled s(quadratic, half);
          s.add_rings(c, stiffness);
          EXPECT_EQ(s.radius(), c);
        }
}

TEST(Axisymmetry, PlaneBodiesWithInertiaSpringsAndSupportsHaveNoRadius) {
  for (bool quadratic : {false, true})
    for (bool half : {false, true})
      for (Real mass : {0.0, 1e-3, 1e6}) {
        Assembled s(quadratic, half);
        EXPECT_EQ(s.radius(), -1);
        for (Index k = 0; k < 2 * s.bodies.nodes(); ++k) s.add(k, k, mass);
        for (Index n = 0; n < s.bodies.nodes(); ++n) {
          if (s.bodies.X[n][0] < 0.8) s.add(2 * n, 2 * n, 1e30);  // held
          if (s.bodies.X[n][1] == 0) s.add(2 * n, 2 * n, 1e2);    // springs in one direction
        }
        EXPECT_EQ(s.radius(), -1) << quadratic << half << mass;
      }
}

TEST(Axisymmetry, ABedOfSpringsAlongOneComponentIsNoRing) {
  for (int c : {0, 1})
    for (Real stiffness : {1.0, 1e-8}) {
      Assembled s(false);
      s.add_bed(c, stiffness);
      EXPECT_EQ(s.radius(), -1);
    }
}

TEST(Axisymmetry, SpaceHasThreeComponentsAndNoRadius) {
  const std::vector<Index> at = {0, 1, 2};
  const std::vector<Real> a = {1, 1, 1};
  EXPECT_EQ(radial_component({3, 3, at.data(), at.data(), a.data()}, {0, 0, 0}), -1);
}
