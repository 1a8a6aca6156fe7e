// Rigid motions that nothing determines: named, and the field with the least of them returned.
#include <gtest/gtest.h>

#include "bodies.h"
#include "core/condensed/rigid_motions.h"
#include "core/condensed/undetermined.h"
#include "core/solver.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// Solves, and expects so many motions, none of which x has a part along.
Solution expect_undetermined(const ContactProblem& p, Index count) {
  const Solution s = solve(p, Settings());
  EXPECT_EQ(s.status, Status::converged);
  EXPECT_LT(s.certificate.residual, 1e-10);
  EXPECT_EQ(s.undetermined.cols(), count);
  if (s.undetermined.cols() == 0) return s;
  const Vector part = s.undetermined.transpose() * p.system->D.cwiseProduct(s.x);
  const Real size = std::sqrt(s.x.dot(p.system->D.cwiseProduct(s.x)));
  for (Index k = 0; k < part.size(); ++k) {
    const Vector v = s.undetermined.col(k);
    EXPECT_LT(std::abs(part[k]), 1e-9 * size * std::sqrt(v.dot(p.system->D.cwiseProduct(v))));
    EXPECT_LT((p.system->A * v).norm(), 1e-9 * (p.system->A * s.x).norm() / size);
  }
  return s;
}

}  // namespace

TEST(Undetermined, ABlockOnAFrictionlessPlaneFloatsAlongIt) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.law = Law::frictionless;
    o.shear = 0;
    const Solution s = expect_undetermined(problem_of(o), d == 2 ? 1 : 3);
    o.law = Law::coulomb;
    o.mu = 0;
    const Scene with_tangents = block(o);
    const Solution t = expect_undetermined(problem_of(o), d == 2 ? 1 : 3);
    EXPECT_LT((s.x.norm() - t.x.norm()), 1e-9 * s.x.norm());
  }
}

TEST(Undetermined, NoFrictionAtSomeNodesOnlyLeavesNothingFree) {
  BlockOptions o;
  o.shear = 0;
  Scene s = block(o);
  s.friction.setZero();
  s.friction[2] = 0.3;
  expect_undetermined(s.system().problem(), 0);
}

TEST(Undetermined, OrdinaryScenesHaveNone) {
  BlockOptions o;
  expect_undetermined(problem_of(o), 0);
  o.clamp_side = true;
  expect_undetermined(problem_of(o), 0);
}

TEST(Undetermined, ATouchOfLoadAlongTheFloatingMotionIsNoEquilibrium) {
  for (Law law : {Law::frictionless, Law::coulomb}) {
    BlockOptions o;
    o.law = law;
    o.mu = 0;
    o.shear = 1e-4;
    const Solution s = solve(problem_of(o), Settings());
    EXPECT_EQ(s.status, Status::no_equilibrium);
    ASSERT_EQ(s.unheld_motion.size(), s.x.size());
    EXPECT_GT(problem_of(o).increment.F.dot(s.unheld_motion), 0);
  }
}

TEST(Undetermined, BranchesBarTheMotionsThatTheyStandAgainst) {
  BlockOptions o;
  o.d = 3;
  o.cells = 2;
  const ContactProblem p = problem_of(o);
  const DenseMatrix W = rigid_motions(*p.system, 100000);
  using Branch = SemismoothNewton::Branch;
  std::vector<Branch> branches(p.nodes());  // all closed and stuck
  EXPECT_EQ(left_free(W, p, branches).cols(), 0);
  for (Branch& b : branches) b.stick = false;  // closed, free to slide: two slides and a turn
  EXPECT_EQ(left_free(W, p, branches).cols(), 3);
  for (Branch& b : branches) {  // all slide one way, against friction
    b.g = 1;
    b.d = {0.6, 0.8};
  }
  const DenseMatrix along = left_free(W, p, branches);
  ASSERT_EQ(along.cols(), 1);
  const Vector w = along.col(0).tail(p.contact_dofs());
  EXPECT_NEAR(std::abs(w[1] / w.segment(1, 2).norm()), 0.6, 1e-9);
  EXPECT_NEAR(w[1] * 0.8 - w[2] * 0.6, 0, 1e-9 * w.norm());
  for (Branch& b : branches) b.closed = false;
  for (Branch& b : branches) b.g = 0;
  EXPECT_EQ(left_free(W, p, branches).cols(), 6);
}

TEST(Undetermined, TheLeastIsOrthogonalAndDiffersByTheMotionsAlone) {
  const Vector D = Vector::LinSpaced(5, 1, 3);
  const DenseMatrix V = DenseMatrix::Random(5, 2);
  const Vector x = Vector::Random(5), y = least(x, V, D);
  EXPECT_LT((V.transpose() * D.cwiseProduct(y)).norm(), 1e-13);
  const Vector c = V.colPivHouseholderQr().solve(x - y);
  EXPECT_LT((V * c - (x - y)).norm(), 1e-13);
}
