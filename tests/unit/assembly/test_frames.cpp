#include <gtest/gtest.h>

#include "core/solver.h"
#include "unit/scene.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// Turns the lowest corner of a block into a corner of two obstacles: a wall beside the floor.
/// tilt: angle between the wall's normal and the direction -x.
Scene with_wall(const BlockOptions& o, Real tilt = 0) {
  Scene s = block(o);
  const Index m = o.cells + 1, rows = o.d == 2 ? 1 : m;
  const std::size_t floor = s.points.size();
  for (Index z = 0; z < m; ++z)
    for (Index y = 0; y < rows; ++y) {
      ContactPoint p;
      const Index node = o.d == 2 ? m * z : m * (y + m * z);  // x = 0
      for (int c = 0; c < o.d; ++c) p.dof[c] = o.d * node + c;
      p.normal[0] = -std::cos(tilt);
      p.normal[o.d - 1] = -std::sin(tilt);
      p.friction = s.points.front().friction;
      s.points.push_back(p);
    }
  const Index all = Index(s.points.size());
  s.gap = Vector::Zero(all);
  s.friction = Vector::Constant(all, o.mu);
  EXPECT_GT(s.points.size(), floor);
  return s;
}

Eigen::MatrixXd dense(const Scene& s) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(s.n, s.n);
  for (std::size_t k = 0; k < s.a.size(); ++k) A(s.i[k], s.j[k]) += s.a[k];
  return A;
}

/// W T = [I, 0] and T [W; data] = I: w are coordinates of the free displacements.
void expect_inverse(const Scene& s) {
  const LocalSystem local(s.triplets(), s.d, s.points);
  const Eigen::MatrixXd T = local.basis().T, W = local.basis().W;
  const Index w = local.basis().local_dofs();
  EXPECT_LT((W * T.leftCols(w) - Eigen::MatrixXd::Identity(w, w)).norm(), 1e-13 * w);
  EXPECT_LT((W * T.rightCols(T.cols() - w)).norm(), 1e-13 * w);
}

}  // namespace

TEST(Frames, TheBasisAndItsInverseAreInverseToEachOther) {
  for (int d : {2, 3})
    for (bool clamped : {false, true})
      for (Real tilt : {0.0, 0.7}) {
        BlockOptions o;
        o.d = d;
        o.cells = 3;
        o.clamp_side = clamped;
        o.angle = clamped ? 0 : 0.4;
        expect_inverse(block(o));
        o.angle = 0;
        Scene s = with_wall(o, tilt);
        if (clamped && d == 3)  // an oblique normal on nodes that are held in part
          for (ContactPoint& p : s.points)
            if (p.normal[2] == -1) p.normal = {0.36, 0.48, -0.8};
        if (!clamped || d == 3) expect_inverse(s);
      }
}

TEST(Frames, TwoNormalsWithAHeldComponentInCommonAreInvertedToo) {
  BlockOptions o;
  o.d = 3;
  o.cells = 2;
  Scene s = block(o);
  const ContactPoint corner = s.points.front();
  s.points.push_back(corner);
  s.points.front().normal = {0.36, 0.48, -0.8};
  s.points.back().normal = {0.6, -0.64, -0.48};
  s.entry(corner.dof[0], corner.dof[0]) = 1e30;  // a support along x
  expect_inverse(s);
}

TEST(Frames, TheMatrixOfACornerIsTransformedAsDenseAlgebraSays) {
  for (int d : {2, 3})
    for (bool half : {false, true}) {
      BlockOptions o;
      o.d = d;
      o.cells = 2;
      o.clamp_side = true;
      Scene s = with_wall(o, 0.5);
      for (ContactPoint& p : s.points)
        if (p.normal[d - 1] == -1) p.normal[0] = 0.6, p.normal[d - 1] = -0.8;
      const Eigen::MatrixXd A = dense(s);
      if (half) {
        Scene lower = s;
        lower.i.clear(), lower.j.clear(), lower.a.clear();
        for (std::size_t k = 0; k < s.a.size(); ++k)
          if (s.i[k] >= s.j[k]) {
            lower.i.push_back(s.i[k]);
            lower.j.push_back(s.j[k]);
            lower.a.push_back(s.a[k]);
          }
        s.i = lower.i, s.j = lower.j, s.a = lower.a;
      }
      Triplets t = s.triplets();
      t.half = half;
      const LocalSystem local(t, d, s.points);
      const Eigen::MatrixXd T = local.basis().T;
      const Index w = local.basis().local_dofs();
      Eigen::MatrixXd free = A;
      for (Index i = 0; i < s.n; ++i)
        if (A(i, i) > 1e20) free.row(i).setZero();
      const Eigen::MatrixXd all = T.transpose() * free * T;
      const Eigen::MatrixXd got = local.system()->entries();
      EXPECT_LT((got - all.topLeftCorner(w, w)).norm(), 1e-13 * got.norm()) << d << half;
      // prescribed displacements load the body through K = T_w'A T_D
      const Vector data = Vector::Random(local.fixed_dofs());
      Vector b = Vector::Zero(s.n);
      for (Index i = 0, k = 0; i < s.n; ++i)
        if (A(i, i) > 1e20) b[i] = 1e30 * data[k++];
      const Vector F = local.increment(b, {}, s.laws()).increment.F;
      EXPECT_LT((F + all.topRightCorner(w, data.size()) * data).norm(), 1e-12 * F.norm());
    }
}

TEST(Frames, ACornerBetweenTwoObstaclesPenetratesNeitherWhateverTheirOrder) {
  for (int d : {2, 3})
    for (Real tilt : {0.0, 0.5}) {  // a right angle, and a groove
      BlockOptions o;
      o.d = d;
      o.cells = d == 2 ? 6 : 3;
      o.mu = 0;
      o.law = Law::frictionless;
      o.shear = -6;  // towards the wall
      Scene s = with_wall(o, tilt);
      Vector first;
      for (int order = 0; order < 2; ++order) {
        const Posed posed = s.system();
        const Solution a = solve(posed.problem(), Settings());
        ASSERT_EQ(a.status, Status::converged) << d << tilt;
        const Vector u = posed.to_global(a.x), f = posed.force_to_global(a.certificate.r);
        Vector total = Vector::Zero(3);
        for (const ContactPoint& p : s.points) {
          Real u_N = 0;
          for (int c = 0; c < d; ++c) u_N += p.normal[c] * u[p.dof[c]];
          EXPECT_LT(u_N, 1e-12 * u.cwiseAbs().maxCoeff());
        }
        for (Index i = 0; i < s.n; ++i) total[i % d] += f[i] + s.b[i];
        EXPECT_LT(total.norm(), 1e-10 * s.b.norm());
        if (order == 0) first = f;  // in 3D a rigid motion along the wall stays free
        EXPECT_LT((f - first).norm(), 1e-9 * f.norm());
        std::reverse(s.points.begin(), s.points.end());
      }
    }
}

TEST(Frames, EachNormalOfACornerHasItsOwnGapAndNoFriction) {
  BlockOptions o;
  o.mu = 0.3;
  o.shear = -6;
  Scene s = with_wall(o);
  for (std::size_t p = 0; p < s.points.size(); ++p)
    s.gap[Index(p)] = s.points[p].normal[1] == -1 ? 1e-4 : 3e-4;
  const Posed posed = s.system();
  const Solution a = solve(posed.problem(), Settings());
  ASSERT_EQ(a.status, Status::converged);
  const Vector u = posed.to_global(a.x);
  EXPECT_NEAR(u[0], -3e-4, 1e-15);  // the corner is the first node
  EXPECT_NEAR(u[1], -1e-4, 1e-15);
  int shared = 0;
  for (Index k = 0; k < posed.nodes(); ++k)
    if (posed.local().node(k).shared) {
      ++shared;
      EXPECT_EQ(posed.problem().tangents(k), 0);
      EXPECT_EQ(posed.problem().increment.mu[k], 0);
    }
  EXPECT_EQ(shared, 2);
}

TEST(Frames, NoTangentialLawIsPosedAlongTheEdgeBetweenTwoObstacles) {
  BlockOptions o;
  o.d = 3;
  o.cells = 2;
  o.mu = 0.3;
  const Posed posed = with_wall(o).system();
  int shared = 0;
  for (Index k = 0; k < posed.nodes(); ++k) {
    shared += posed.local().node(k).shared;
    EXPECT_EQ(posed.problem().tangents(k), posed.local().node(k).shared ? 0 : 2);
  }
  EXPECT_EQ(shared, 6);
}

TEST(Frames, TheNearestOfTwoFlanksHoldsTheTipOfAGrooveWhoseOtherComponentsAreHeld) {
  for (int flank = 0; flank < 2; ++flank) {
    BlockOptions o;
    o.mu = 0.3;
    o.clamp_side = true;
    Scene s = block(o);
    const ContactPoint tip = s.points.front();
    const Real sine[2] = {0.6, 0.8}, drop[2] = {3e-3, flank == 0 ? 3.5e-3 : 1e-3};
    s.points.erase(s.points.begin());
    for (int k = 0; k < 2; ++k) {  // each asks u_y >= -drop, at u_x = 2e-3
      s.points.push_back(tip);
      s.points.back().normal = {k == 0 ? -std::sqrt(1 - sine[k] * sine[k]) : 0.6, -sine[k], 0};
    }
    s.entry(tip.dof[0], tip.dof[0]) = 1e30;  // a support along x
    s.b[tip.dof[0]] = 1e30 * 2e-3;
    const Index m = Index(s.points.size());
    s.gap = Vector::Constant(m, INFINITY);
    for (int k = 0; k < 2; ++k)
      s.gap[m - 2 + k] = s.points[m - 2 + k].normal[0] * 2e-3 + sine[k] * drop[k];
    s.friction = Vector::Constant(m, o.mu);
    const Posed posed = s.system();
    ASSERT_EQ(posed.nodes(), m - 1);
    const Solution a = solve(posed.problem(), Settings());
    ASSERT_EQ(a.status, Status::converged);
    const Vector u = posed.to_global(a.x);
    EXPECT_NEAR(u[tip.dof[0]], 2e-3, 1e-15);
    EXPECT_NEAR(u[tip.dof[1]], -std::min(drop[0], drop[1]), 1e-14);
    EXPECT_EQ(posed.problem().tangents(m - 2), 0);
    EXPECT_TRUE(posed.local().node(m - 2).shared);
    EXPECT_EQ(posed.problem().increment.mu[m - 2], 0);
  }
}

TEST(Frames, BilateralContactWithTwoFlanksAtOneNodeNeedsOneGap) {
  Scene s = block(BlockOptions());
  const ContactPoint tip = s.points.front();
  s.points = {tip, tip};
  s.points[0].normal = {-0.8, -0.6, 0};
  s.points[1].normal = {0.6, -0.8, 0};
  s.entry(tip.dof[0], tip.dof[0]) = 1e30;  // a support along x
  const LocalSystem system(s.triplets(), 2, s.points);
  PointLaws laws{Law::frictionless, true, Vector(2), {}};
  laws.gap << 0.6e-3, 0.8e-3;  // both 1e-3 below
  EXPECT_NEAR(system.increment(s.b, {}, laws).increment.gap[0], 0.6e-3, 1e-18);
  laws.gap[1] = 0.9e-3;
  try {
    system.increment(s.b, {}, laws);
    ADD_FAILURE();
  } catch (const ConflictingObstacles& e) {
    EXPECT_EQ(e.point, 1);
    EXPECT_NE(std::string(e.what()).find("bilateral"), std::string::npos);
  }
  laws.bilateral = false;  // the nearer one alone counts
  EXPECT_NEAR(system.increment(s.b, {}, laws).increment.gap[0], 0.6e-3, 1e-18);
}

TEST(Frames, RoundingOfWhatIsPrescribedAlongAGrooveIsNoOtherGap) {
  BlockOptions o;
  o.d = 3;
  Scene s = block(o);
  const ContactPoint tip = s.points.front();
  const Real turn = 0.3, run = 0.1;  // the groove runs along (cos, sin, 0), and so does the tip
  s.points = {tip, tip};
  s.points[0].normal = {-0.6 * std::sin(turn), 0.6 * std::cos(turn), -0.8};
  s.points[1].normal = {0.8 * std::sin(turn), -0.8 * std::cos(turn), -0.6};
  const Real along[2] = {std::cos(turn), std::sin(turn)};
  for (int c = 0; c < 2; ++c) {
    s.entry(tip.dof[c], tip.dof[c]) = 1e30;
    s.b[tip.dof[c]] = 1e30 * run * along[c];
  }
  const LocalSystem system(s.triplets(), 3, s.points);
  ASSERT_EQ(system.nodes(), 1);
  const PointLaws laws{Law::frictionless, true, Vector::Zero(2), {}};
  EXPECT_NEAR(system.increment(s.b, {}, laws).increment.gap[0], 0, 1e-16);
}

TEST(Frames, NormalsThatFaceEachOtherOnWhatIsFreeAreRefused) {
  BlockOptions o;
  o.clamp_side = true;
  Scene s = block(o);
  const ContactPoint tip = s.points.back();
  s.entry(tip.dof[0], tip.dof[0]) = 1e30;
  s.points.push_back(tip);
  s.points.back().normal = {0.6, 0.8, 0};
  try {
    LocalSystem(s.triplets(), 2, s.points);
    ADD_FAILURE();
  } catch (const ConflictingObstacles& e) {
    EXPECT_EQ(e.point, Index(s.points.size()) - 1);
  }
}

TEST(Frames, DependentNormalsAtANodeAreRefused) {
  Scene s = block(BlockOptions());
  s.points.push_back(s.points.front());
  s.points.back().normal = {0, 1, 0};
  EXPECT_THROW(LocalSystem(s.triplets(), 2, s.points), IllegalInput);
  s.points.back().normal = {std::sin(1e-4), -std::cos(1e-4),
                            0};  // nearly the floor's, no rival of it
  EXPECT_THROW(LocalSystem(s.triplets(), 2, s.points), IllegalInput);
}

TEST(Frames, NormalsThreeDegreesApartAreBothObeyed) {
  Scene s = block(BlockOptions());
  s.points.push_back(s.points.front());
  s.points.back().normal = {std::sin(0.05), -std::cos(0.05), 0};
  const LocalSystem local(s.triplets(), 2, s.points);
  EXPECT_TRUE(local.node(0).shared);
}

TEST(Frames, TheObstaclesForceStaysOnItsNormalWhereASupportHoldsAComponent) {
  BlockOptions o;
  o.law = Law::frictionless;
  o.clamp_side = true;
  o.shear = 0;
  Scene s = block(o);
  for (ContactPoint& p : s.points) p.normal = {0.6, -0.8, 0};
  const Posed posed = s.system();
  const Solution a = solve(posed.problem(), Settings());
  const Vector f = posed.force_to_global(a.certificate.r);
  Real pressing = 0;
  for (const ContactPoint& p : s.points) {
    EXPECT_NEAR(0.8 * f[p.dof[0]] + 0.6 * f[p.dof[1]], 0, 1e-12);
    pressing += f[p.dof[1]];
  }
  EXPECT_GT(pressing, 1);
}

TEST(Dirichlet, AContactNodeOnSpringsIsNoSupport) {
  // two nodes that nothing couples, on springs; and a row that only a Dirichlet condition explains
  Scene s;
  s.d = 2;
  s.n = 6;
  for (Index k = 0; k < 6; ++k) {
    s.i.push_back(k);
    s.j.push_back(k);
    s.a.push_back(k < 4 ? 100.0 : 1e30);
  }
  s.i.insert(s.i.end(), {0, 1});
  s.j.insert(s.j.end(), {1, 0});
  s.a.insert(s.a.end(), {10.0, 10.0});
  ContactPoint p;
  p.dof = {2, 3, -1};
  p.normal = {0, -1, 0};
  s.points.push_back(p);
  const LocalSystem local(s.triplets(), 2, s.points);
  EXPECT_EQ(local.nodes(), 1);
  EXPECT_EQ(local.fixed_dofs(), 2);
}

TEST(Dirichlet, LumpedSpringsAreNoSupportAlthoughTheirRowsHaveZeros) {
  for (bool coupled : {true, false}) {  // by stiffness, beside springs; or nothing at all
    Scene s;
    s.d = 2;
    s.n = 8;
    const auto add = [&](Index i, Index j, Real a) {
      s.i.push_back(i);
      s.j.push_back(j);
      s.a.push_back(a);
    };
    for (Index k = 0; k < 8; ++k)
      for (Index l = 0; l < 8; ++l) add(k, l, k == l ? (k < 4 ? 0.52 : (k < 6 ? 1.0 : 1e30)) : 0.0);
    if (coupled) {
      add(1, 3, -0.1);
      add(3, 1, -0.1);
    }
    for (Index node = 0; node < 3; ++node) {
      ContactPoint p;
      p.dof = {2 * node, 2 * node + 1, -1};
      p.normal = {0, -1, 0};
      s.points.push_back(p);
    }
    const Dirichlet held(s.triplets(), dofs_of(s.points));
    EXPECT_EQ(held.size(), 4);  // two rows of the identity, two by a penalty
    for (Index i = 0; i < 8; ++i) EXPECT_EQ(held.holds(i), i >= 4) << i;
  }
}
