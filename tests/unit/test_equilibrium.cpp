#include <gtest/gtest.h>

#include "core/condensed/equilibrium.h"
#include "core/condensed/rigid_motions.h"
#include "scene.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

Balance balance_of(const BlockOptions& o) {
  const Posed posed = block(o).system();
  return balance(rigid_motions(*posed.problem().system, 10000), posed.problem()).balance;
}

bool unheld(const BlockOptions& o) { return balance_of(o) == Balance::unheld; }

}  // namespace

TEST(Equilibrium, SlidingStartsAtTheFrictionAngle) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = 3;
    for (Real excess : {0.9, 0.999, 1.001, 1.1}) {
      o.shear = 0.3 * o.pressure * excess;  // far from tipping, at 0.5 of the pressure
      EXPECT_EQ(unheld(o), excess > 1) << d << " " << excess;
    }
  }
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
