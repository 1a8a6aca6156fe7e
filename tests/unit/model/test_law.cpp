#include <gtest/gtest.h>

#include "core/model/law.h"

using namespace frictioncg;

TEST(Law, LimitIsMuTimesThePressureOfAClosedNode) {
  const NodeLaw coulomb{0.5, 0, false};
  EXPECT_EQ(coulomb.limit(4), 2);
  EXPECT_EQ(coulomb.limit(-4), 0);
  EXPECT_EQ(coulomb.limit(0, 4), 2);
  EXPECT_EQ(coulomb.limit(-1, 4), 2);
  EXPECT_EQ(coulomb.limit(5, 4), 0);  // open
  EXPECT_EQ(coulomb.limit(4, 4), 0);
}

TEST(Law, BilateralContactRubsUnderTensionToo) {
  const NodeLaw bilateral{0.5, 0, true};
  EXPECT_EQ(bilateral.limit(-4), 2);
  EXPECT_EQ(bilateral.limit(9, -4), 2);
  EXPECT_EQ(bilateral.limit(9, 4), 2);
}

TEST(Law, AGivenLimitDoesNotAskForPressureAndWithoutFrictionThereIsNone) {
  const NodeLaw tresca{0, 0.5, false};
  EXPECT_EQ(tresca.limit(4), 0.5);
  EXPECT_EQ(tresca.limit(-4), 0.5);
  EXPECT_EQ(tresca.limit(5, 0), 0.5);
  const NodeLaw none{0, 0, false};
  EXPECT_EQ(none.limit(4), 0);
  EXPECT_EQ(none.limit(0, 4), 0);
}

TEST(Law, AGivenLimitAndMuAddUpAndWhatIsOpenKeepsTheGivenLimit) {
  const NodeLaw law{0.5, 3, false};
  EXPECT_EQ(law.limit(4), 5);
  EXPECT_EQ(law.limit(-4), 3);
  EXPECT_EQ(law.limit(5, 4), 3);  // open
  EXPECT_TRUE((NodeLaw{0, 3, false}).has_friction());
  EXPECT_TRUE((NodeLaw{0.5, 0, false}).has_friction());
}

TEST(Law, NormalResidualIsTheSmallerOfClosingAndForceOrClosingAlone) {
  const NodeLaw unilateral{1, 0, false}, bilateral{1, 0, true};
  EXPECT_EQ(unilateral.normal_residual(3, 2), 2);
  EXPECT_EQ(unilateral.normal_residual(1, 2), 1);
  EXPECT_EQ(unilateral.normal_residual(1, -2), -2);
  EXPECT_EQ(unilateral.normal_residual(-1, 2), -1);
  EXPECT_EQ(bilateral.normal_residual(3, 2), 3);
  EXPECT_EQ(bilateral.normal_residual(-3, -5), -3);
}

TEST(Law, ANodeIsClosedWhereItsForceExceedsWhatWouldCloseIt) {
  const NodeLaw unilateral{1, 0, false}, bilateral{1, 0, true};
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
  EXPECT_EQ(law_of(i, 1).limit(4), 8);
  i.g.resize(0);
  EXPECT_EQ(law_of(i, 1).limit(4), 1);
  EXPECT_TRUE(law_of(i, 1).has_friction());
  i.law = Law::tresca;
  i.g = Vector::Constant(2, 7);
  EXPECT_EQ(law_of(i, 1).limit(4), 7);
  i.g[1] = 0;
  EXPECT_FALSE(law_of(i, 1).has_friction());
  EXPECT_TRUE(law_of(i, 0).bilateral);
}

TEST(Law, TangentialNormIsThatOfTheTangentsOfItsNode) {
  System s;
  s.first = {1, 4, 5};
  const Vector x = (Vector(5) << 9, 8, 3, 4, 7).finished();
  EXPECT_EQ(tangential_norm(s, 0, x), 5);
  EXPECT_EQ(tangential_norm(s, 1, x), 0);
}
