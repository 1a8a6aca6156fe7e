// Rigid motions of each body, out of candidates for all of them as one.
#include <gtest/gtest.h>

#include "../condensed/bodies.h"
#include "core/statics/floating.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

void expect_floating(const System& system, Index count) {
  const Eigen::MatrixXd W = floating_motions(system);
  ASSERT_EQ(W.rows(), system.dofs());
  ASSERT_EQ(W.cols(), count);
  for (Index k = 0; k < count; ++k) {
    const Vector w = W.col(k);
    EXPECT_NEAR(w.dot(system.D.cwiseProduct(w)), 1, 1e-12);
    EXPECT_LT(w.dot(system.A * w), 1e-12);
  }
  if (count == 0) return;
  EXPECT_EQ(W.colPivHouseholderQr().rank(), count);
}

}  // namespace

TEST(Floating, BodiesAreThePartsOfTheGraphOfA) {
  BlockOptions o;
  o.cells = 2;
  const ContactProblem one = problem_of(o);
  EXPECT_EQ(bodies_of(one.system->A).count, 1);
  const ContactProblem three = beside(one, 3);
  const Bodies bodies = bodies_of(three.system->A);
  ASSERT_EQ(bodies.count, 3);
  for (Index i = 0; i < three.dofs(); ++i)
    for (Matrix::InnerIterator e(three.system->A, i); e; ++e)
      EXPECT_EQ(bodies.of[i], bodies.of[e.col()]);
}

TEST(Floating, ABlockHasAllRigidMotionsUntilItIsHeld) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = 2;
    expect_floating(*problem_of(o).system, d == 2 ? 3 : 6);
    o.clamp_side = true;  // u_x = 0 on a face: translations along it and the turn in its plane
    expect_floating(*problem_of(o).system, d == 2 ? 1 : 3);
  }
}

TEST(Floating, EachBodyHasItsOwn) {
  BlockOptions o;
  o.cells = 2;
  expect_floating(*beside(problem_of(o), 3).system, 9);
}

TEST(Floating, AStiffnessOfAMillionthIsASupport) {
  BlockOptions o;
  const ContactProblem p = problem_of(o);
  for (Real spring : {1e-6, 1e-16}) {
    System system = *p.system;
    for (Index i = 0; i < system.dofs(); ++i) system.A.coeffRef(i, i) += spring * system.D[i];
    expect_floating(system, spring > 1e-10 ? 0 : 3);
  }
}

TEST(Floating, ASmallBodyFarFromTheOriginIsFound) {
  BlockOptions o;
  o.cells = 2;
  o.size = 1e-3;
  Scene s = block(o);
  for (Index p = 0; p < s.n; p += 2) {  // turns about a point at (-1, -2)
    s.modes(p, 2) -= 2;
    s.modes(p + 1, 2) += 1;
  }
  expect_floating(*s.system().problem().system, 3);
}

TEST(Floating, WithoutCandidatesThereAreNone) {
  BlockOptions o;
  Scene s = block(o);
  s.modes.resize(0, 0);
  expect_floating(*s.system().problem().system, 0);
  System other = *block(o).system().problem().system;
  for (Index rows : {0, other.dofs() - 1, other.dofs() + 1}) {  // of another scene
    other.rigid_modes = [rows] { return Eigen::MatrixXd(Eigen::MatrixXd::Ones(rows, 3)); };
    expect_floating(other, 0);
  }
}
