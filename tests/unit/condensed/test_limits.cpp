// One sliding limit after the other, alone and as the layer that answers.
#include <gtest/gtest.h>

#include "../random_scene.h"
#include "../verifier.h"
#include "newtons_answer.h"
#include "core/condensed/limits.h"
#include "core/solver.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

Settings bounded(Index steps) {
  Settings settings;
  settings.nbiter = steps;
  return settings;
}

}  // namespace

TEST(Limits, TheirAnswerIsNewtonsWhereBothArrive) {
  expect_newtons_answer([](const CondensedProblem& p) { return by_limits(p, bounded(1000)); },
                        1e-7);
}

TEST(Limits, AreTriedUnderCoulombsLawAloneAndWithinTheBound) {
  for (Law law : {Law::frictionless, Law::tresca}) {
    OnContact condensed(block(sheared_at_side(2, law)));
    const Attempt a = by_limits(condensed.problem(), bounded(1000));
    EXPECT_FALSE(a.solved);
    EXPECT_EQ(a.steps, 0);
  }
  OnContact condensed(block(sheared_at_side(3)));
  for (Index bound : {0, 1, 7}) {
    const Attempt a = by_limits(condensed.problem(), bounded(bound));
    EXPECT_FALSE(a.solved);
    EXPECT_LE(a.steps, bound);
  }
}

TEST(Limits, SolveWhatNewtonsMethodDoesNot) {
  int answers = 0;
  for (const auto& [seed, bounds] : {std::pair{11137u, false},
                                     {22350u, false},
                                     {211u, true},
                                     {490u, true},
                                     {1168u, true},
                                     {1184u, true},
                                     {1833u, true},
                                     {1883u, true}}) {  // held by friction alone
    const Recipe recipe = bounds ? with_bounds(random_recipe(seed)) : random_recipe(seed);
    const Scene s = make_scene(recipe);
    const Posed system = s.system();
    const Solution a = solve(system.problem(), Settings());
    EXPECT_EQ(a.status, Status::converged) << recipe;
    EXPECT_LT(verify(s, system.to_global(a.x), system.force_to_global(a.certificate.r)).worst(),
              1e-7)
        << recipe;
    answers += a.layer == Layer::limits;
  }
  EXPECT_GE(answers, 7);
}
