// Rigid motions of each body, out of candidates for all of them as one.
#include <gtest/gtest.h>

#include "bodies.h"
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
    EXPECT_LT(w.dot(system.entries() * w), 1e-12);
  }
  if (count == 0) return;
  EXPECT_EQ(W.colPivHouseholderQr().rank(), count);
}

/// Two bodies of one shape, the first `ratio` times as stiff, its displacements relative to those
/// of the second: u = w + u_soft puts entries of the stiff body beside those of the soft one, whose
/// springs are `held` times D.
AssembledSystem coupled(const AssembledSystem& one, Real ratio, Real held) {
  const Index n = one.dofs();
  const Matrix K = one.A;
  AssembledSystem two = one;
  std::vector<Eigen::Triplet<Real, Index>> entries;
  for (Index i = 0; i < n; ++i)
    for (Matrix::InnerIterator e(K, i); e; ++e) {
      const Index j = static_cast<Index>(e.col());
      for (const auto& [row, column] : {std::pair(i, j), {i, j + n}, {i + n, j}, {i + n, j + n}})
        entries.emplace_back(row, column, ratio * e.value());
      entries.emplace_back(i + n, j + n, e.value() + (i == j ? held * one.D[i] : 0));
    }
  two.A = Matrix(2 * n, 2 * n);
  two.A.setFromTriplets(entries.begin(), entries.end());
  two.D = two.A.diagonal();
  for (Index& f : two.first) f += n;
  const Eigen::MatrixXd M = one.rigid_modes();
  two.body_modes = [n, M] {
    Eigen::MatrixXd both = Eigen::MatrixXd::Zero(2 * n, 6);
    both.topLeftCorner(n, 3) = M;
    both.bottomRightCorner(n, 3) = M;
    both.topRightCorner(n, 3) = -M;  // w of the first, where only the second moves
    return Matrix(both.sparseView());
  };
  return two;
}

}  // namespace

TEST(Floating, BodiesAreThePartsOfTheGraphOfA) {
  BlockOptions o;
  o.cells = 2;
  const ContactProblem one = problem_of(o);
  EXPECT_EQ(bodies_of(one.system->entries()).count, 1);
  const ContactProblem three = beside(one, 3);
  const Bodies bodies = bodies_of(three.system->entries());
  ASSERT_EQ(bodies.count, 3);
  for (Index i = 0; i < three.dofs(); ++i)
    for (Matrix::InnerIterator e(three.system->entries(), i); e; ++e)
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
    AssembledSystem system = assembled(p.system);
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

TEST(Floating, OfAStiffBodyOnASoftOneThatIsHeldTheMotionsAreSharp) {
  BlockOptions o;
  o.cells = 4;
  const AssembledSystem one = assembled(problem_of(o).system);
  for (const Real ratio : {1., 1e4, 1e7, 1e9}) {
    const Eigen::MatrixXd W = floating_motions(coupled(one, ratio, 1));
    ASSERT_EQ(W.cols(), 3);
    EXPECT_LT(W.bottomRows(one.dofs()).norm(), 1e-14 * W.norm()) << ratio;
  }
}

TEST(Floating, OfTwoCoupledBodiesThatFloatNoMotionIsFoundTwice) {
  BlockOptions o;
  o.cells = 4;
  const AssembledSystem one = assembled(problem_of(o).system);
  for (const Real ratio : {1., 1e2, 1e4}) expect_floating(coupled(one, ratio, 0), 6);
}

TEST(Floating, WhatABodyDoesNotDoAloneItDoesWithAnother) {
  BlockOptions o;
  o.cells = 2;
  const AssembledSystem one = assembled(problem_of(o).system);
  const Index n = one.dofs();
  const Eigen::MatrixXd M = one.rigid_modes();
  AssembledSystem two = one;
  std::vector<Eigen::Triplet<Real, Index>> entries;
  for (Index i = 0; i < n; ++i) {
    for (Matrix::InnerIterator e(one.A, i); e; ++e)
      for (Index k : {Index(0), n}) entries.emplace_back(i + k, Index(e.col()) + k, e.value());
    if (std::abs(M(i, 1)) < 0.5) continue;  // springs along y: each slides along x on its own
    for (const auto& [row, column, sign] :
         {std::tuple(i, i, 1), {i + n, i + n, 1}, {i, i + n, -1}, {i + n, i, -1}})
      entries.emplace_back(row, column, sign * one.D[i]);
  }
  two.A = Matrix(2 * n, 2 * n);
  two.A.setFromTriplets(entries.begin(), entries.end());
  two.D = two.weight = two.A.diagonal();
  two.first = {2 * n};
  two.body_modes = [n, M] {
    Eigen::MatrixXd both = Eigen::MatrixXd::Zero(2 * n, 6);
    both.topLeftCorner(n, 3) = M;
    both.bottomRightCorner(n, 3) = M;
    return Matrix(both.sparseView());
  };
  expect_floating(two, 4);
}

TEST(Floating, OfTheInteriorAreThoseThatMoveNoContactDof) {
  Eigen::MatrixXd W(4, 3);
  W << 1, 2, 0, 3, 1, 1, 0, 1, 2, 0, 2, 4;  // rows 2 and 3 move by c_2 + 2 c_3
  const Eigen::MatrixXd of_two = motions_of_interior(W, 2), Z = one_for_each({0, 1}, of_two);
  ASSERT_EQ(Z.cols(), 2);
  EXPECT_LT((Z - Eigen::MatrixXd::Identity(4, 2)).norm(), 1e-14);
  EXPECT_EQ(one_for_each({0}, of_two).cols(), 0);                        // more than asked for
  EXPECT_EQ(one_for_each({0, 1}, motions_of_interior(W, 1)).cols(), 0);  // less
  const Eigen::MatrixXd all = motions_of_interior(W.topRows(3), 3);
  EXPECT_LT((one_for_each({0, 1, 2}, all) - Eigen::Matrix3d::Identity()).norm(), 1e-14);
}

TEST(Floating, AMotionThatMovesAContactDofALittleIsNoneOfTheInterior) {
  Eigen::MatrixXd W(3, 2);
  W << 1, 0, 0, 1, 1e-5, 0;
  const Eigen::MatrixXd Z = one_for_each({1}, motions_of_interior(W, 2));
  ASSERT_EQ(Z.cols(), 1);
  EXPECT_LT((Z - Eigen::Vector3d(0, 1, 0)).norm(), 1e-14);
}

TEST(Floating, RowsTellMotionsBestFarFromEachOther) {
  Eigen::MatrixXd Z(5, 2);
  Z << 1, 0, 1, 1, 1, 2, 1, 3, 1, 4;  // a translation, a rotation about the first dof
  EXPECT_EQ(telling_rows(Z), (std::vector<Index>{0, 4}));
  Z.col(1) = 2 * Z.col(0);
  EXPECT_TRUE(telling_rows(Z).empty());
  EXPECT_TRUE(telling_rows(Eigen::MatrixXd(5, 0)).empty());
}

TEST(Floating, ZerosThatAreStoredBetweenBodiesJoinNothing) {
  BlockOptions o;
  o.cells = 2;
  AssembledSystem s = assembled(beside(problem_of(o), 2).system);
  const Bodies bodies = bodies_of(s.A);
  ASSERT_EQ(bodies.count, 2);
  const Eigen::MatrixXd M = s.rigid_modes();
  s.body_modes = [bodies, M] {
    Eigen::MatrixXd each = Eigen::MatrixXd::Zero(M.rows(), 6);
    for (Index i = 0; i < Index(M.rows()); ++i) each.block(i, 3 * bodies.of[i], 1, 3) = M.row(i);
    return Matrix(each.sparseView());
  };
  expect_floating(s, 6);
  for (Index i = 0; i < s.dofs(); ++i)
    for (Index j = 0; j < s.dofs(); ++j)
      if (bodies.of[i] != bodies.of[j]) s.A.coeffRef(i, j) = 0;
  s.A.makeCompressed();
  ASSERT_EQ(bodies_of(s.A).count, 2);
  expect_floating(s, 6);
}

TEST(Floating, DofsOfBodiesMayTakeTurns) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = 2;
    const Index count = 5, each = d == 2 ? 3 : 6;
    const AssembledSystem s = assembled(beside(problem_of(o), count).system);
    const Index n = s.dofs(), one = n / count;
    const auto at = [&](Index i) { return i % one * count + i / one; };
    std::vector<Eigen::Triplet<Real, Index>> entries;
    for (Index i = 0; i < n; ++i)
      for (Matrix::InnerIterator a(s.A, i); a; ++a)
        entries.emplace_back(at(i), at(Index(a.col())), a.value());
    AssembledSystem t;
    t.dimension = d;
    t.A = Matrix(n, n);
    t.A.setFromTriplets(entries.begin(), entries.end());
    t.D = t.weight = t.A.diagonal();
    t.first = {n};
    Eigen::MatrixXd M = s.rigid_modes();
    const Eigen::MatrixXd before = M;
    for (Index i = 0; i < n; ++i) M.row(at(i)) = before.row(i);
    t.rigid_modes = [M] { return M; };
    expect_floating(t, count * each);
    EXPECT_TRUE(may_be_rigid(t, floating_motions(t) * Vector::Ones(count * each)));
  }
}

TEST(Floating, WithoutCandidatesThereAreNone) {
  BlockOptions o;
  Scene s = block(o);
  s.modes.resize(0, 0);
  expect_floating(*s.system().problem().system, 0);
  AssembledSystem other = assembled(block(o).system().problem().system);
  for (Index rows : {0, other.dofs() - 1, other.dofs() + 1}) {  // of another scene
    other.rigid_modes = [rows] { return Eigen::MatrixXd(Eigen::MatrixXd::Ones(rows, 3)); };
    expect_floating(other, 0);
  }
}

TEST(Floating, ABendingIsNoRigidMotionHoweverLittleItCosts) {
  BlockOptions o;
  const ContactProblem two = beside(problem_of(o), 2);
  const Eigen::MatrixXd M = two.system->rigid_modes();
  const Bodies bodies = bodies_of(two.system->entries());
  Vector w = M * Vector::LinSpaced(3, 1, 2);
  for (Index i = 0; i < w.size(); ++i)
    if (bodies.of[i] == 1) w[i] = -2 * M(i, 2);  // each body by its own motion
  EXPECT_TRUE(may_be_rigid(*two.system, w));
  EXPECT_TRUE(may_be_rigid(*two.system, w + 1e-6 * Vector::Random(w.size())));
  EXPECT_FALSE(may_be_rigid(*two.system, w.cwiseProduct(w)));
  AssembledSystem unknown = assembled(two.system);
  unknown.rigid_modes = {};
  EXPECT_TRUE(may_be_rigid(unknown, w.cwiseProduct(w)));
}
