// Every layer on the contact dofs gives signs of life, step by step.
#include <gtest/gtest.h>

#include "../scene.h"
#include "../statics.h"
#include "../statics/bodies.h"
#include "core/condensed/interior_point.h"
#include "core/condensed/semismooth_newton.h"
#include "core/condensed/limits.h"
#include "core/solver.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

struct Listener final : Observer {
  std::array<Index, works> steps{}, begun{};
  Real last = -1, seconds = -1;
  bool hears = true;
  void iterate(Index, StepLabel, const Vector&) override {}
  void step(Work work, Real residual) override {
    ++steps[static_cast<int>(work)];
    last = residual;
  }
  bool listens() override { return hears; }
  void begin(Work work, double of) override {
    ++begun[static_cast<int>(work)];
    seconds = of;
  }
  Index operator[](Work work) const { return steps[static_cast<int>(work)]; }
};

}  // namespace

TEST(Listener, HearsOfEveryNewtonStepWithTheResidualOfItsLaws) {
  OnContact blocks(block(BlockOptions()));
  CondensedProblem p = blocks.problem();
  Listener listener;
  p.observer = &listener;
  SemismoothNewton newton(p);
  ASSERT_EQ(newton.solve(40), SemismoothNewton::Outcome::converged);
  EXPECT_EQ(listener[Work::newton], newton.steps());
  EXPECT_EQ(listener.last, newton.residual());
}

TEST(Listener, HearsOfProximalPointsWithSpringsAndWithout) {
  OnContact standing(ladder(60, 0.3, 0.2));
  CondensedProblem p = standing.problem();
  Listener listener;
  p.observer = &listener;
  const Attempt a = by_proximal_points(p, 1000);
  ASSERT_TRUE(a.solved);
  EXPECT_GT(listener[Work::proximal], 0);
  EXPECT_GT(listener[Work::newton], 0);
  EXPECT_EQ(listener[Work::proximal] + listener[Work::newton], a.steps);
}

TEST(Listener, HearsOfTheInteriorPointUntilItsProductsAreGone) {
  OnContact standing(ladder(60, 0.3, 0.2));
  CondensedProblem p = standing.problem();
  Listener listener;
  p.observer = &listener;
  CentralPath path(p);
  const Index steps = path.follow(60);
  EXPECT_GT(steps, 2);
  EXPECT_EQ(listener[Work::interior_point], steps);
  EXPECT_LT(listener.last, 1e-6);
}

TEST(Listener, HearsOfTheGradientOnTheContactDofsAndOfItsResidualWhereItListens) {
  OnContact blocks(block(BlockOptions()));
  CondensedProblem p = blocks.problem();
  Settings settings;
  settings.newton = false;
  for (bool hears : {true, false}) {
    Listener listener;
    listener.hears = hears;
    p.observer = &listener;
    const Solution s = by_regularization(p, settings, Vector());
    EXPECT_EQ(listener[Work::gradient], s.iterations);
    EXPECT_EQ(listener.last > 0, hears);
    EXPECT_LT(listener.last, 1e-6);
  }
}

TEST(Listener, HearsOfTheFactorizationOnceBeforeItIsMade) {
  const Posed posed = block(BlockOptions()).system();
  const ContactProblem& problem = posed.problem();
  Solver solver(problem.system);
  Listener listener;
  for (int k = 0; k < 2; ++k) solver.solve(problem.increment, Settings(), {}, &listener);
  EXPECT_EQ(listener.begun[static_cast<int>(Work::factorization)], 1);
  EXPECT_EQ(listener.seconds, estimate_costs(*problem.system).condensed);
  EXPECT_GT(listener.seconds, 0);
  EXPECT_LT(listener.seconds, 1e-3);
  EXPECT_GT(listener[Work::newton], 0);
  Settings without;
  without.newton = false;
  solver.solve(problem.increment, without, {}, &listener);
  EXPECT_GT(listener[Work::gradient], 0);
}
