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

/// One process that calls itself all of them, and counts what it is asked.
class Alone final : public Processes {
 public:
  explicit Alone(const Matrix& A) : A_(A) {}
  void multiply(const Vector& x, Vector& Ax) const override { Ax = A_ * x; }
  Vector magnitude(const Vector& x) const override { return frictioncg::magnitude(A_, x); }
  void sum(Real*, Index) const override { ++sums; }
  Real largest(Real value) const override { return value; }
  Vector gathered(const Vector& own) const override { return own; }
  Vector combined(const Vector& own, const Both&) const override { return own; }
  Bodies bodies() const override { return bodies_of(A_); }

  mutable Index sums = 0;

 private:
  const Matrix A_;
};

/// The same problem on a system whose A is the processes'.
ContactProblem shared(const ContactProblem& problem, std::shared_ptr<const Alone>& alone) {
  const System& s = *problem.system;
  alone = std::make_shared<const Alone>(s.A);
  const auto system = std::make_shared<System>();
  system->dimension = s.dimension;
  system->D = s.D;
  system->weight = s.weight;
  system->first = s.first;
  system->rigid_modes = s.rigid_modes;
  system->processes = alone;
  return {system, problem.increment};
}

Solution solve_shared(const ContactProblem& problem, const SceneInBlocks& scene, Index* sums) {
  std::shared_ptr<const Alone> alone;
  const ContactProblem all = shared(problem, alone);
  Settings settings;
  settings.tol = 1e-9;
  MultigridSolver solver(all.system, make_hierarchy(scene.system->A, scene.blocks, scene.modes));
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
