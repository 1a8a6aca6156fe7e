// A system that processes share goes by their products, sums and gatherings, here of one alone.
#include <gtest/gtest.h>

#include "../multigrid/scene_in_blocks.h"
#include "core/statics/equilibrium.h"
#include "core/statics/undetermined.h"
#include "core/multigrid/multigrid_solver.h"
#include "core/statics/floating.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// A system as one process of several has it: it counts the sums and products it is asked for.
struct Alone final : System {
  explicit Alone(const System& of) : System(of), whole(of) {}
  void multiply(const Vector& x, Vector& Ax) const override {
    ++products;
    whole.multiply(x, Ax);
  }
  Vector multiply_sized(const Vector& x, Vector& Ax) const override {
    if (!x.isZero(0)) ++products;
    return whole.multiply_sized(x, Ax);
  }
  void move_contact(const Vector& dx_C, Vector& r) const override { whole.move_contact(dx_C, r); }
  Bodies bodies() const override { return whole.bodies(); }
  const Matrix& entries() const override { throw std::logic_error("entries"); }
  void sum(Real*, Index) const override { ++sums; }

  const System& whole;
  mutable Index sums = 0, products = 0;
};

Solution solve_shared(const ContactProblem& problem, const SceneInBlocks& scene, Index* sums) {
  const auto alone = std::make_shared<const Alone>(*problem.system);
  const ContactProblem all{alone, problem.increment};
  Settings settings;
  settings.tol = 1e-9;
  MultigridSolver solver(all.system,
                         make_hierarchy(scene.system->entries(), scene.blocks, scene.modes));
  const Solution s = solver.solve(all, settings, {}, nullptr);
  if (sums) *sums = alone->sums;
  return s;
}

Solution solve_alone(const ContactProblem& problem) {
  Settings settings;
  settings.tol = 1e-9;
  return MultigridSolver(problem.system).solve(problem, settings, {}, nullptr);
}

SparseOptions block(bool clamped) {
  SparseOptions o;
  o.cells = {5, 5, 5};
  o.clamp_side = clamped;
  if (!clamped) o.shear = 1;
  return o;
}

}  // namespace

TEST(Processes, OneAloneTakesTheIterationsAndFindsTheAnswerOfASystemThatIsNotShared) {
  for (bool clamped : {true, false}) {
    const SceneInBlocks scene(block(clamped));
    const ContactProblem problem = scene.posed.problem();
    Index sums = 0;
    const Solution a = solve_shared(problem, scene, &sums), b = solve_alone(problem);
    EXPECT_EQ(a.status, Status::converged);
    EXPECT_EQ(a.iterations, b.iterations);
    EXPECT_LT((a.x - b.x).norm(), 1e-10 * b.x.norm());
    EXPECT_NEAR(a.certificate.residual, b.certificate.residual, 1e-11);
    // a reduction or two for each purpose, not one for each direction
    EXPECT_LT(sums, 12 * a.iterations);
  }
}

TEST(Processes, AnIncrementTakesAProductWithAForItsStartAndOneForItsAnswer) {
  SceneInBlocks scene(block(true));
  ContactProblem problem = scene.posed.problem();
  const auto alone = std::make_shared<const Alone>(*problem.system);
  problem.system = alone;
  MultigridSolver solver(alone, std::move(scene.hierarchy));
  Index before = 0;
  for (Real load : {1.0, 1.1, 1.3}) {
    problem.increment.F = load * scene.posed.problem().increment.F;
    const Solution s = solver.solve(problem, Settings(), {}, nullptr);
    EXPECT_EQ(s.status, Status::converged);
    if (load > 1) {
      EXPECT_EQ(alone->products - before, 2) << load;
    }
    before = alone->products;
  }
}

TEST(Processes, LoadsThatNothingHoldsAreShownByTheirColumnsTogether) {
  for (Law law : {Law::coulomb, Law::tresca}) {
    SparseOptions o = block(false);
    o.law = law;
    o.mu = 0.05;
    o.shear = 9;
    const SceneInBlocks scene(o);
    const ContactProblem problem = scene.posed.problem();
    const Solution a = solve_shared(problem, scene, nullptr), b = solve_alone(problem);
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.status, Status::no_equilibrium);
    EXPECT_LT((a.unheld_motion - b.unheld_motion).norm(), 1e-9 * b.unheld_motion.norm());
  }
}

TEST(Processes, MotionsThatNothingDeterminesAreThoseOfASystemThatIsNotShared) {
  SparseOptions o = block(false);
  o.law = Law::frictionless;
  o.shear = 0;
  const SceneInBlocks scene(o);
  const ContactProblem problem = scene.posed.problem();
  const Solution a = solve_shared(problem, scene, nullptr), b = solve_alone(problem);
  EXPECT_EQ(a.undetermined.cols(), 3);
  EXPECT_EQ(b.undetermined.cols(), 3);
  EXPECT_LT((a.x - b.x).norm(), 1e-8 * b.x.norm());
}
