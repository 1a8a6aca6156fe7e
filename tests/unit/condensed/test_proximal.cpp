// Proximal points alone.
#include <gtest/gtest.h>

#include "../statics.h"
#include "../statics/bodies.h"
#include "core/condensed/semismooth_newton.h"

using namespace frictioncg;
using namespace frictioncg::test;

TEST(Proximal, FindsTheLaddersThatStandWithoutAStart) {
  for (const auto& [degrees, floor, wall] :
       {std::tuple{60., 0.3, 0.2}, {40., 0.6, 0.2}, {65., 0.2, 0.2}, {50., 0.4, 0.2}}) {
    OnContact ladder_on_contact(ladder(degrees, floor, wall));
    const Attempt a = by_proximal_points(ladder_on_contact.problem(), 1000);
    ASSERT_TRUE(a.solved) << degrees;
    EXPECT_LE(a.steps, 200) << degrees;
    EXPECT_LT(ladder_on_contact.residual(a.x), 1e-8) << degrees;
    EXPECT_EQ(a.branches.size(), 6u);
  }
}

TEST(Proximal, TheSpringsAreGoneAtTheEnd) {
  BlockOptions o;
  o.clamp_side = true;
  o.shear = 4;
  OnContact blocks(block(o));
  const CondensedProblem p = blocks.problem();
  SemismoothNewton newton(p);
  ASSERT_EQ(newton.solve(40), SemismoothNewton::Outcome::converged);
  const Attempt a = by_proximal_points(p, 1000);
  ASSERT_TRUE(a.solved);
  EXPECT_LT((a.x - newton.x()).norm(), 1e-12 * newton.x().norm());
  EXPECT_FALSE(a.undetermined);
}

TEST(Proximal, ABodyThatNothingHoldsCreepsWithinTheBound) {
  OnContact falling(ladder(40, 0.1, 0.1));
  const Attempt a = by_proximal_points(falling.problem(), 1000);
  EXPECT_FALSE(a.solved);
  // its way from point to point does not shrink: 400 without looking at it
  EXPECT_LE(a.steps, 100);
  EXPECT_EQ(a.status, Status::stagnated);
  EXPECT_GT(a.x.norm(), 1e4);  // from point to point: 9e2 by springs that pull back
  for (Index bound : {0, 1, 7}) {
    const Attempt b = by_proximal_points(falling.problem(), bound);
    EXPECT_FALSE(b.solved);
    EXPECT_LE(b.steps, bound);
  }
}
