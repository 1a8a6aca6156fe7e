#pragma once
// A layer on the contact dofs, where Newton's method from stick arrives as well.
#include <gtest/gtest.h>

#include "../statics/bodies.h"
#include "core/condensed/semismooth_newton.h"

namespace frictioncg::test {

/// Blocks that are sheared at a side, in 2D and 3D.   layer: Attempt(const CondensedProblem&)
template <class Layer>
void expect_newtons_answer(Layer layer, Real error) {
  for (int d : {2, 3})
    for (Real mu : {0.1, 0.3, 1.}) {
      BlockOptions o = sheared_at_side(d);
      o.mu = mu;
      OnContact condensed(block(o));
      const CondensedProblem p = condensed.problem();
      SemismoothNewton newton(p);
      ASSERT_EQ(newton.solve(40), SemismoothNewton::Outcome::converged);
      const Attempt a = layer(p);
      ASSERT_TRUE(a.solved) << d << " " << mu;
      EXPECT_LE((a.x - newton.x()).norm(), error * newton.x().norm()) << d << " " << mu;
    }
}

}  // namespace frictioncg::test
