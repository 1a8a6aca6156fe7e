#include <gtest/gtest.h>

#include "core/condensed/equilibrium.h"
#include "scene.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

bool unheld(const BlockOptions& o) {
  const Posed system = block(o).system();
  const ContactProblem& p = system.problem();
  Condensation condensation;
  EXPECT_EQ(condensation.factor(*p.system, 1e9), Condensation::Outcome::done);
  const Vector D = p.system->D.tail(p.contact_dofs());
  return cannot_be_held({condensation.S(), condensation.reduce(p.increment.F), D, p});
}

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
