#include <gtest/gtest.h>

#include "core/model/law.h"

using namespace frictioncg;

namespace {
constexpr Real none = std::numeric_limits<Real>::infinity();  // of a cap
}

TEST(Law, LimitIsMuTimesThePressureOfAClosedNode) {
  const NodeLaw coulomb{0.5};
  EXPECT_EQ(coulomb.limit(4), 2);
  EXPECT_EQ(coulomb.limit(-4), 0);
  EXPECT_EQ(coulomb.limit(0, 4), 2);
  EXPECT_EQ(coulomb.limit(-1, 4), 2);
  EXPECT_EQ(coulomb.limit(5, 4), 0);  // open
  EXPECT_EQ(coulomb.limit(4, 4), 0);
}

TEST(Law, BilateralContactRubsUnderTensionToo) {
  const NodeLaw bilateral{0.5, 0, none, true};
  EXPECT_EQ(bilateral.limit(-4), 2);
  EXPECT_EQ(bilateral.limit(9, -4), 2);
  EXPECT_EQ(bilateral.limit(9, 4), 2);
}

TEST(Law, AGivenLimitDoesNotAskForPressureAndWithoutFrictionThereIsNone) {
  const NodeLaw tresca{0, 0.5, none, false, true};
  EXPECT_EQ(tresca.limit(4), 0.5);
  EXPECT_EQ(tresca.limit(-4), 0.5);
  EXPECT_EQ(tresca.limit(5, 0), 0.5);
  const NodeLaw smooth;
  EXPECT_EQ(smooth.limit(4), 0);
  EXPECT_EQ(smooth.limit(0, 4), 0);
}

TEST(Law, CohesionActsWhereTheNodeIsClosedAndACapBoundsTheSum) {
  const NodeLaw law{0.5, 3, 6};
  EXPECT_EQ(law.limit(4), 5);
  EXPECT_EQ(law.limit(-4), 3);
  EXPECT_EQ(law.limit(6), 6);
  EXPECT_EQ(law.limit(7), 6);
  EXPECT_FALSE(law.capped(6));
  EXPECT_TRUE(law.capped(7));
  EXPECT_EQ(law.limit(0, 4), 5);
  EXPECT_EQ(law.limit(5, 4), 0);  // open
  const NodeLaw bilateral{0.5, 3, 6, true};
  EXPECT_EQ(bilateral.limit(9, -4), 5);
  EXPECT_EQ(bilateral.limit(9, -7), 6);
}

TEST(Law, OnlyALimitAboveZeroIsFrictionAndOnlyCohesionJumps) {
  EXPECT_TRUE((NodeLaw{0, 3}).has_friction());
  EXPECT_TRUE((NodeLaw{0.5}).has_friction());
  EXPECT_FALSE((NodeLaw{0.5, 3, 0}).has_friction());
  EXPECT_TRUE((NodeLaw{0, 3}).coheres());
  EXPECT_FALSE((NodeLaw{0.5}).coheres());
  EXPECT_FALSE((NodeLaw{0.5, 3, 0}).coheres());
  EXPECT_FALSE((NodeLaw{0.5, 3, none, true}).coheres());
  EXPECT_FALSE((NodeLaw{0, 3, none, false, true}).coheres());
}

TEST(Law, ANodeThatTouchesWithoutAForceBearsAnyPartOfItsCohesion) {
  const Vector w = Eigen::Vector2d(4, 9);
  const NodeLaw law{0.5, 3};
  const auto miss = [&](Real x_N, Real x_T, Real r_N, Real r_T) {
    const Violation v = violation(law, 0, w, Eigen::Vector2d(x_N, x_T), Eigen::Vector2d(r_N, r_T));
    return std::sqrt(v.normal + v.friction);
  };
  EXPECT_NEAR(miss(0, 0, 0, 3), 0, 1e-15);         // sticks
  EXPECT_NEAR(miss(0, 1, 0, 3), 0, 1e-15);         // slips at the limit
  EXPECT_NEAR(miss(0, 1, 0, 2), 0, 1e-15);         // opens
  EXPECT_NEAR(miss(0, 1, 0, 0), 0, 1e-15);         // as if open
  EXPECT_NEAR(miss(0, 1, 0, 3.6), 0.2, 1e-15);     // no more than all of it
  EXPECT_NEAR(miss(0, -1, 0, 2), 2.0 / 3, 1e-15);  // along the slip
  EXPECT_NEAR(miss(-1e-9, 1, 0, 2), 2e-9, 1e-15);
  EXPECT_NEAR(miss(0, 1, 1e-9, 2), 0.5e-9, 1e-15);
  EXPECT_NEAR(miss(-1, 1, 0, 2), 2.0 / 3, 1e-15);  // open
  EXPECT_NEAR(miss(0, 1, 8, 2), 5.0 / 3, 1e-15);   // closed
}

TEST(Law, NormalResidualIsTheSmallerOfClosingAndForceOrClosingAlone) {
  const NodeLaw unilateral{1}, bilateral{1, 0, none, true};
  EXPECT_EQ(unilateral.normal_residual(3, 2), 2);
  EXPECT_EQ(unilateral.normal_residual(1, 2), 1);
  EXPECT_EQ(unilateral.normal_residual(1, -2), -2);
  EXPECT_EQ(unilateral.normal_residual(-1, 2), -1);
  EXPECT_EQ(bilateral.normal_residual(3, 2), 3);
  EXPECT_EQ(bilateral.normal_residual(-3, -5), -3);
}

TEST(Law, ANodeIsClosedWhereItsForceExceedsWhatWouldCloseIt) {
  const NodeLaw unilateral{1}, bilateral{1, 0, none, true};
  EXPECT_TRUE(unilateral.closed(0, 1));
  EXPECT_TRUE(unilateral.closed(-1, 0));
  EXPECT_FALSE(unilateral.closed(1, 0));
  EXPECT_FALSE(unilateral.closed(0, 0));
  EXPECT_TRUE(bilateral.closed(1, 0));
}

TEST(Law, FrictionResidualInsideOnAndOutsideTheDisc) {
  const Real c = 2, g = 5;
  Tangent r(2), x(2);
  r << 3, 0;
  x << 0.5, 0;  // |r + c x| = 4 < g: what sticks must not have moved
  EXPECT_EQ(friction_residual(r, x, c, g), Tangent(-c * x));
  x << 1, 0;  // on the disc
  EXPECT_EQ(friction_residual(r, x, c, g), Tangent(-c * x));
  x << 0, 2;  // |(3, 4)| = 5, on it
  EXPECT_EQ(friction_residual(r, x, c, g), Tangent(-c * x));
  x << 0, 6;  // (3, 12) outside: r - 5 (3, 12)/|(3, 12)|
  const Tangent outside = friction_residual(r, x, c, g);
  const Real norm = std::sqrt(153.0);
  EXPECT_NEAR(outside[0], 3 - 15 / norm, 1e-15);
  EXPECT_NEAR(outside[1], -60 / norm, 1e-15);
  x << 7, 0;  // slips along its force, which is short of the limit by 2
  EXPECT_NEAR(friction_residual(r, x, c, g)[0], -2, 1e-15);
  r << 5, 0;
  EXPECT_NEAR(friction_residual(r, x, c, g).norm(), 0, 1e-15);
}

TEST(Law, WithoutALimitAnyTangentialForceIsLeftOver) {
  Tangent r(1), x(1);
  r << -3;
  x << 0;
  EXPECT_EQ(friction_residual(r, x, 2, 0)[0], -3);
  r << 0;
  EXPECT_EQ(friction_residual(r, x, 2, 0)[0], 0);
}

TEST(Law, OfANodeIsThatOfItsIncrement) {
  Increment i;
  i.mu = Vector::Constant(2, 0.25);
  i.g = Vector::Constant(2, 7);
  EXPECT_FALSE(law_of(i, 1).has_friction());
  EXPECT_EQ(law_of(i, 1).limit(4), 0);
  i.bilateral = true;
  EXPECT_TRUE(law_of(i, 1).bilateral);
  i.law = Law::coulomb;
  EXPECT_EQ(law_of(i, 1).limit(4), 1);
  i.cohesion = Vector::Constant(2, 3);
  EXPECT_EQ(law_of(i, 1).limit(4), 4);
  i.cap = Vector::Constant(2, 3.5);
  EXPECT_EQ(law_of(i, 1).limit(4), 3.5);
  EXPECT_FALSE(law_of(i, 1).given);
  EXPECT_TRUE(law_of(i, 1).has_friction());
  i.law = Law::tresca;
  i.g = Vector::Constant(2, 7);
  EXPECT_EQ(law_of(i, 1).limit(4), 7);
  EXPECT_TRUE(law_of(i, 1).given);
  i.g[1] = 0;
  EXPECT_FALSE(law_of(i, 1).has_friction());
  EXPECT_TRUE(law_of(i, 0).bilateral);
}
