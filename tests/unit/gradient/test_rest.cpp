// Where stick is a face: which nodes come to rest.
#include <gtest/gtest.h>

#include "../condensed/by_hand.h"
#include "core/gradient/release_rule.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// One node that slides at x_T = 1e-3, on a stiffness of 1; rest wants 0.5 of friction.
struct Sliding {
  ByHand hand{2, diag({1, 1}), vec({1, 0.5})};
  Iterate it{hand.problem};
  explicit Sliding(Real g) {
    it.x = vec({0, 1e-3});
    it.g = vec({g});
    it.faces.start(it.x, it.g, Tangents::sliding, true);
    it.rows.start(hand.problem.increment.F - hand.problem.system->entries() * it.x);
  }
  bool comes_to_rest(Real v, Real residual) {
    return come_to_rest(it, vec({0, v}), 1e-4, vec({1}), residual) && it.faces.at_rest(0);
  }
};

}  // namespace

TEST(Rest, ANodeThatCreepsByLessThanTheResidualExplainsIsHeldWithoutATurn) {
  EXPECT_FALSE(Sliding(1).comes_to_rest(1, 1e-3));  // it goes on sliding
  Sliding creeping(1);
  EXPECT_TRUE(creeping.comes_to_rest(1, 0.1));
  EXPECT_EQ(creeping.it.x[1], 0);
  EXPECT_NEAR(creeping.it.rows.r()[1], 0.5, 1e-15);
}

TEST(Rest, ANodeThatAStepHasTurnedIsHeldOnlyWhereFrictionCanHoldIt) {
  EXPECT_TRUE(Sliding(1).comes_to_rest(100, 1e-9));  // from x_T = -9e-3
  Sliding weak(0.3);
  EXPECT_FALSE(weak.comes_to_rest(100, 1e-9));
  EXPECT_NEAR(weak.it.x[1], 0.5 - 0.3, 1e-15);  // where friction is at its limit
}
