// Loads that work next to nothing on motions along which no normal stands.
#include <gtest/gtest.h>

#include "bodies.h"
#include "core/statics/floating.h"
#include "core/statics/undetermined.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// A block on a floor, held by nothing else, whose load pushes it along by a share of what presses.
struct Pushed {
  explicit Pushed(Real share) {
    BlockOptions o;
    o.cells = 3;
    problem = problem_of(o);
    system = problem.system.get();
    W = floating_motions(*system);
    const DenseMatrix M = system->rigid_modes();
    along = M.col(0);
    up = M.col(1);
    F = -system->D.cwiseProduct(up) + share * system->D.cwiseProduct(along);
  }
  Real work(const Vector& w) const { return F.dot(w); }
  ContactProblem problem;
  const System* system;
  DenseMatrix W;
  Vector along, up, F;
};

}  // namespace

TEST(UncertainWork, IsLeftOutUpToWhatIsTold) {
  Pushed p(1e-6);
  const Vector before = p.F;
  const Real work = p.work(p.along), pressing = p.work(p.up);
  EXPECT_EQ(leave_out_uncertain_work(*p.system, p.W, 0, p.F), 0);
  EXPECT_EQ(leave_out_uncertain_work(*p.system, p.W, 1e-9, p.F), 0);
  EXPECT_EQ((p.F - before).norm(), 0);
  const DenseMatrix longer = 3 * p.W;
  const Real share = leave_out_uncertain_work(*p.system, longer, 1e-4, p.F);
  EXPECT_GT(share, 1e-8);
  EXPECT_LT(share, 1e-6);
  EXPECT_LT(std::abs(p.work(p.along)), 1e-9 * work);
  EXPECT_NEAR(p.work(p.up) / pressing, 1, 1e-5);
  EXPECT_LT((p.F - before).norm(), 1e-5 * before.norm());
}

TEST(UncertainWork, OfMotionsThatNormalsResistStays) {
  Pushed p(0);
  const Vector before = p.F;
  EXPECT_EQ(leave_out_uncertain_work(*p.system, p.W, 1, p.F), 0);
  EXPECT_EQ((p.F - before).norm(), 0);
  EXPECT_EQ(leave_out_uncertain_work(*p.system, DenseMatrix(p.F.size(), 0), 1, p.F), 0);
}
