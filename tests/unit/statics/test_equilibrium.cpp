// The conic test alone: nothing, or the motion that shows that a load is not held.
#include <gtest/gtest.h>

#include "bodies.h"
#include "../condensed/by_hand.h"
#include "core/condensed/bounded_pressure.h"
#include "core/statics/equilibrium.h"
#include "core/statics/rigid_motions.h"
#include "core/solver.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// Whether the load is shown not to be held; checks the proof node by node.
bool unheld(const ContactProblem& p, const DenseMatrix& W) {
  const std::optional<Vector> motion = unheld_motion(W, p);
  if (!motion) return false;
  const Vector& w = *motion;
  EXPECT_LT(std::abs(w.dot(p.system->entries() * w)), 1e-11 * w.dot(p.system->D.cwiseProduct(w)));
  Real pull = p.increment.F.dot(w), most = 0;
  for (Index i = 0; i < p.nodes(); ++i) {
    const Index N = p.system->first[i];
    const Real slide = w.segment(N + 1, p.tangents(i)).norm();
    if (p.increment.law == Law::tresca) pull -= p.increment.g[i] * slide;
    if (!std::isfinite(p.increment.gap[i])) continue;
    const Real mu = p.increment.law == Law::coulomb ? p.increment.mu[i] : 0;
    const Real w_N = p.increment.bilateral ? std::abs(w[N]) : w[N];
    most = std::max(most, w_N + mu * slide);
  }
  EXPECT_GT(pull, 0);
  // whatever pressed with less than 1e5 times the load would do less work than the load
  EXPECT_LT(1e5 * p.increment.F.lpNorm<1>() * most, pull);
  return true;
}

bool unheld(const ContactProblem& p) { return unheld(p, rigid_motions(p.system->entries(), p.system->D)); }

bool unheld(const BlockOptions& o) { return unheld(problem_of(o)); }

}  // namespace

TEST(Equilibrium, SlidingStartsAtTheFrictionAngle) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = 3;
    for (Real excess : {0.9, 0.999, 0.999999, 1.000001, 1.001, 1.1}) {
      o.shear = 0.3 * o.pressure * excess;  // far from tipping, at 0.5 of the pressure
      EXPECT_EQ(unheld(problem_of(o)), excess > 1) << d << " " << excess;
    }
  }
}

TEST(Equilibrium, ExactlyAtTheLimitNothingIsProven) {
  BlockOptions o;
  o.shear = 0.3 * o.pressure;
  EXPECT_FALSE(unheld(problem_of(o)));
  o.shear *= 1 + 1e-11;
  EXPECT_FALSE(unheld(problem_of(o)));
}

TEST(Equilibrium, TippingStartsWhereTheLoadLeavesTheBase) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = 3;
    o.mu = 2;
    for (Real excess : {0.99, 1.01}) {
      o.shear = 0.5 * o.pressure * excess;
      EXPECT_EQ(unheld(o), excess > 1) << d << " " << excess;
    }
  }
}

TEST(Equilibrium, LiftingIsNotHeldAndASupportedBodyAlwaysIs) {
  BlockOptions o;
  o.pressure = -1;
  o.shear = 0;
  EXPECT_TRUE(unheld(o));
  o.pressure = 1;
  EXPECT_FALSE(unheld(o));
  o.clamp_side = true;  // u_x held: no sliding
  o.shear = 100;
  o.pressure = 50;
  EXPECT_FALSE(unheld(o));
}

TEST(Equilibrium, OneOfTwoBodiesThatSlidesIsEnough) {
  BlockOptions o;
  o.shear = 2;
  ContactProblem p = beside(problem_of(o), 2);
  EXPECT_FALSE(unheld(p));
  p.increment.mu.tail(p.nodes() / 2).setConstant(0.1);
  EXPECT_TRUE(unheld(p));
}

TEST(Equilibrium, ABalancedOrAbsentLoadIsHeldByNothing) {
  BlockOptions o;
  ContactProblem p = problem_of(o);
  p.increment.F.setZero();
  EXPECT_FALSE(unheld(p));
  p.increment.F = p.system->entries() * Vector::Random(p.dofs());  // rounding of a balanced load
  EXPECT_FALSE(unheld(p));
  EXPECT_FALSE(unheld(p, DenseMatrix(p.dofs(), 0)));
}

TEST(Equilibrium, WhatRoundingLeavesOfABalancedLoadMovesNothing) {
  ContactProblem p;
  const auto system = std::make_shared<AssembledSystem>();
  system->first = {0, 2, 4};
  system->A.resize(4, 4);  // 0: every motion is rigid
  system->weight = Vector::Ones(4);
  p.system = system;
  p.increment.law = Law::frictionless;
  p.increment.gap = Vector::Zero(2);
  const DenseMatrix along = Eigen::Vector4d(0, 1, 0, 1);  // it slides freely
  p.increment.F = Eigen::Vector4d(0, 0.1 + 0.2, 0, -0.3);
  ASSERT_NE(p.increment.F.sum(), 0);
  EXPECT_FALSE(unheld_motion(along, p));
  p.increment.F[1] = 0.31;
  EXPECT_TRUE(unheld_motion(along, p));
}

TEST(Equilibrium, AMotionThatIsNotQuiteRigidIsNoProofOfWhatTheBodyCarries) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    ContactProblem p = problem_of(o);
    p.increment.gap.setConstant(std::numeric_limits<Real>::infinity());  // nothing touches
    const DenseMatrix rigid = rigid_motions(p.system->entries(), p.system->D);
    const DenseMatrix soft = rigid + 1e-6 * rigid.cwiseAbs().maxCoeff() *
                                         DenseMatrix::Random(rigid.rows(), rigid.cols());
    for (Index k = 0; k < soft.cols(); ++k)  // passes for rigid by its energy
      ASSERT_LT(soft.col(k).dot(p.system->entries() * soft.col(k)),
                1e-11 * soft.col(k).dot(p.system->D.cwiseProduct(soft.col(k))));
    p.increment.F = p.system->entries() * Vector::Random(p.dofs());
    EXPECT_FALSE(unheld_motion(soft, p)) << d;
    EXPECT_FALSE(unheld_motion(rigid, p)) << d;
    p.increment.F = problem_of(o).increment.F;  // the load presses: nothing holds it
    EXPECT_TRUE(unheld_motion(rigid, p)) << d;
  }
}

TEST(Equilibrium, BilateralContactHoldsATensionAndFrictionlessOneNoSlide) {
  BlockOptions o;
  o.pressure = -1;
  o.shear = 0;
  ContactProblem p = problem_of(o);
  p.increment.bilateral = true;
  EXPECT_FALSE(unheld(p));
  p.increment.mu.setZero();
  EXPECT_FALSE(unheld(p));
  o.shear = 0.1;
  p.increment.F = problem_of(o).increment.F;
  EXPECT_TRUE(unheld(p));
}

TEST(Equilibrium, AGivenLimitHoldsUpToItsSum) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = 3;
    o.law = Law::tresca;
    const int nodes = d == 2 ? 4 : 16;
    o.mu = 0.01;  // each node holds so much, whatever presses it
    for (Real excess : {0.999, 1.001}) {
      o.shear = excess * nodes * o.mu;
      EXPECT_EQ(unheld(problem_of(o)), excess > 1) << d;
    }
    o.shear = 0;
    o.pressure = -1;  // lifts
    EXPECT_TRUE(unheld(problem_of(o))) << d;
    ContactProblem p = problem_of(o);
    p.increment.bilateral = true;
    EXPECT_FALSE(unheld(p)) << d;
  }
}

TEST(Equilibrium, NodesThatCannotTouchHoldNothing) {
  BlockOptions o;
  o.shear = 0;
  ContactProblem p = problem_of(o);
  p.increment.gap.head(p.nodes() - 1).setConstant(std::numeric_limits<Real>::infinity());
  EXPECT_TRUE(unheld(p));    // it tips over the last node
  p.increment.gap[0] = 1e3;  // far, but within reach
  EXPECT_FALSE(unheld(p));
}

TEST(Equilibrium, CohesionHoldsNothingWhereNothingCanTouch) {
  BlockOptions o;
  o.shear = 0;
  ContactProblem p = problem_of(o);
  p.increment.F.setZero();
  for (Index i = 0; i < p.nodes(); ++i) p.increment.F[p.system->first[i] + 1] = 0.1;
  p.increment.cohesion = Vector::Constant(p.nodes(), 1);
  EXPECT_FALSE(unheld(p));
  p.increment.gap.setConstant(std::numeric_limits<Real>::infinity());
  EXPECT_TRUE(unheld(p));
}

TEST(Equilibrium, ACapThatNoPressureReachesIsNone) {
  BlockOptions o;
  o.shear = 0;
  ContactProblem p = problem_of(o);
  p.increment.mu.setConstant(1e-300);
  p.increment.cohesion = Vector::Constant(p.nodes(), 1);
  p.increment.cap = Vector::Constant(p.nodes(), 2);
  for (Real pull : {0.999, 1.001}) {
    for (Index i = 0; i < p.nodes(); ++i) p.increment.F[p.system->first[i] + 1] = pull;
    EXPECT_EQ(unheld(p), pull > 1);
  }
}

TEST(Equilibrium, WhereOnlyAMillionTimesTheLoadWouldHoldNothingIsShown) {
  // a wedge of two faces, almost parallel, without friction: pressures are load over their angle
  for (Real angle : {1e-3, 1e-8}) {
    DenseMatrix S(4, 4);
    S.setZero();
    const ByHand hand = ByHand(2, DenseMatrix::Identity(4, 4), vec({0, 0, 0, 1}));
    DenseMatrix W(4, 2);  // body translations, seen in the frames of the two nodes
    const Real c = std::cos(angle), s = std::sin(angle);
    W << c, s, -s, c, -c, s, -s, -c;
    ContactProblem p = hand.problem;
    p.increment.F = vec({0, 0, 0, -1});
    EXPECT_FALSE(unheld_motion(W, p)) << angle;
  }
}

TEST(Equilibrium, TheStiffnessOfABodyBoundsTheFrictionOfBilateralContact) {
  // a block glued normally, with little friction: pressures and tensions that cancel would hold it,
  // but it is too soft for them
  for (int d : {2, 3})
    for (Real shear : {0.3, 2.0}) {
      BlockOptions o;
      o.d = d;
      o.cells = 4;
      o.mu = 0.05;
      o.shear = shear;
      ContactProblem p = problem_of(o);
      p.increment.bilateral = true;
      EXPECT_FALSE(unheld(p));
      const Solution s = solve(p, Settings());
      EXPECT_EQ(s.status, shear > 1 ? Status::no_equilibrium : Status::converged);
      ASSERT_EQ(s.unheld_motion.size(), shear > 1 ? p.dofs() : 0);
      if (shear < 1) continue;
      const Vector& w = s.unheld_motion;
      EXPECT_GT(p.increment.F.dot(w), 0);
      for (Index i = 0; i < p.nodes(); ++i)
        EXPECT_LT(std::abs(w[p.system->first[i]]), 1e-9 * w.lpNorm<Eigen::Infinity>());
    }
}

TEST(Equilibrium, AnAnswerOfBilateralContactIsWithinItsBound) {
  // whatever the verdict, a load whose answer exists is not called impossible
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::srand(seed);
    const DenseMatrix Q = DenseMatrix::Random(8, 8);
    DenseMatrix S = Q * Q.transpose();
    DenseMatrix W = DenseMatrix::Zero(8, 1);  // all slide along alike
    for (int i = 1; i < 8; i += 2) W(i, 0) = 0.5;
    const DenseMatrix P = DenseMatrix::Identity(8, 8) - W * W.transpose();
    S = P * S * P;
    ContactProblem p = ByHand(2, S, Vector::Random(8)).mu(0.02 * seed).bilateral().problem;
    Vector r = Vector::Zero(8);  // of x = 0, stuck: |r_T| <= mu |r_N|
    for (int i = 0; i < 8; i += 2) {
      r[i] = 1 - 2.0 * (std::rand() % 2);
      r[i + 1] = 0.999 * 0.02 * seed;  // all friction is needed
    }
    p.increment.F = r;
    const CondensedProblem condensed{S, p.increment.F, p.system->weight, p};
    EXPECT_FALSE(unheld_at_bounded_pressure(W, condensed)) << seed;
  }
}

TEST(Equilibrium, TheBoundOfBilateralContactKnowsTheGapAndNodesWithoutAForce) {
  // two nodes, of which nothing presses the second
  DenseMatrix S = diag({10, 1, 10, 1});
  S(1, 3) = S(3, 1) = -1;
  S(0, 1) = S(1, 0) = 2;
  S(0, 3) = S(3, 0) = -2;
  const DenseMatrix W = vec({0, 1, 0, 1});
  for (Real gap : {0.0, 1e3})
    for (Real pull : {0.05, 5.0}) {
      const Vector f = vec({1, pull, 0, pull}) + S * vec({gap, 0, gap, 0});
      ByHand by(2, S, f);
      by.mu(0.1).bilateral().gap(gap);  // |r_N| <= 1/0.9 at the first node
      EXPECT_EQ(unheld_at_bounded_pressure(W, by.condensed()).has_value(), pull > 1) << gap;
    }
}

TEST(Equilibrium, TheBoundOfBilateralContactKnowsThatCohesionPresses) {
  // as above; what the second node takes of the pull shears, and presses the first
  DenseMatrix S = diag({10, 1, 10, 1});
  S(1, 3) = S(3, 1) = -1;
  S(0, 1) = S(1, 0) = 2;
  S(0, 3) = S(3, 0) = -2;
  for (Real pull : {0.57, 0.7}) {  // held: r_N = 2 pull - 3, r_T = 2 pull - 1 and 1, to 0.59
    ByHand by(2, S, vec({-1, pull, 0, pull}));
    by.mu(0.1).bilateral().problem.increment.cohesion = vec({0, 1});
    const auto motion = unheld_at_bounded_pressure(vec({0, 1, 0, 1}), by.condensed());
    EXPECT_EQ(motion.has_value(), pull > 0.6);
  }
}
