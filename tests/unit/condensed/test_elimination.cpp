// The elimination alone: S, the condensed load, the field, what floats, and the memory it asks for.
#include <gtest/gtest.h>

#include <numeric>

#include "../statics/bodies.h"
#include "by_hand.h"
#include "core/condensed/elimination.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// A^+ on what is not rigid: the reference of S and f where A_II is singular.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> cod;
  cod.setThreshold(1e-11);
  return cod.compute(A).pseudoInverse();
}

}  // namespace

TEST(Elimination, SchurComplementCondensedLoadAndFieldMatchDenseAlgebra) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = d == 2 ? 7 : 3;
    o.angle = 0.3;
    const ContactProblem p = problem_of(o);
    Elimination elimination;
    ASSERT_EQ(elimination.factor(*p.system, 1e9), Elimination::Outcome::done);
    EXPECT_EQ(elimination.floating().cols(), 0);
    const Eigen::MatrixXd A = p.system->entries();
    const Index I = p.interior(), C = p.contact_dofs();
    const Eigen::MatrixXd to_contact =
        A.bottomLeftCorner(C, I) *
        A.topLeftCorner(I, I).ldlt().solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(I, I)));
    const Eigen::MatrixXd S = A.bottomRightCorner(C, C) - to_contact * A.topRightCorner(I, C);
    EXPECT_LT((elimination.S() - S).norm(), 1e-12 * S.norm());
    EXPECT_EQ((elimination.S() - elimination.S().transpose()).norm(), 0);
    const Vector f = p.increment.F.tail(C) - to_contact * p.increment.F.head(I);
    EXPECT_LT((elimination.condense(p.increment.F) - f).norm(), 1e-12 * f.norm());
    const Vector x_C = Vector::Random(C);
    const Vector x = elimination.recover(x_C);
    EXPECT_LT((x.tail(C) - x_C).norm(), 1e-13 * x_C.norm());
    EXPECT_LT((p.increment.F - p.system->entries() * x).head(I).norm(),
              1e-11 * (p.system->entries() * x).norm());
    const Vector w = elimination.extend(x_C);
    EXPECT_LT((w.tail(C) - x_C).norm(), 1e-13 * x_C.norm());
    EXPECT_LT((p.system->entries() * w).head(I).norm(), 1e-11 * (p.system->entries() * w).norm());
  }
}

TEST(Elimination, WhatFloatsAlongAFrictionlessPlaneIsNamedAndSAndFExistAllTheSame) {
  for (int d : {2, 3})
    for (int bodies : {1, 2}) {
      BlockOptions o;
      o.d = d;
      o.cells = d == 2 ? 4 : 2;
      o.law = Law::frictionless;
      o.shear = 0;
      const ContactProblem p = beside(problem_of(o), bodies);
      Elimination elimination;
      ASSERT_EQ(elimination.factor(*p.system, 1e9), Elimination::Outcome::done);
      const DenseMatrix& V = elimination.floating();
      ASSERT_EQ(V.cols(), bodies * (d == 2 ? 1 : 3));
      EXPECT_LT((p.system->entries() * V).norm(), 1e-11 * p.system->entries().norm() * V.norm());
      const Index I = p.interior(), C = p.contact_dofs();
      EXPECT_EQ(V.bottomRows(C).norm(), 0);
      EXPECT_GT(Eigen::JacobiSVD<DenseMatrix>(V).singularValues().minCoeff(), 0.1);
      const Eigen::MatrixXd A = p.system->entries();
      const Eigen::MatrixXd to_contact =
          A.bottomLeftCorner(C, I) * pseudo_inverse(A.topLeftCorner(I, I));
      const Eigen::MatrixXd S = A.bottomRightCorner(C, C) - to_contact * A.topRightCorner(I, C);
      EXPECT_LT((elimination.S() - S).norm(), 1e-11 * S.norm());
      const Vector f = p.increment.F.tail(C) - to_contact * p.increment.F.head(I);
      EXPECT_LT((elimination.condense(p.increment.F) - f).norm(), 1e-11 * f.norm());
      const Vector x = elimination.recover(Vector::Random(C));
      EXPECT_LT((p.increment.F - p.system->entries() * x).head(I).norm(),
                1e-10 * (p.system->entries() * x).norm());
    }
}

TEST(Elimination, ABodyThatTouchesNothingFloatsByAllItsRigidMotions) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = 2;
    Scene s = block(o);
    s.points.clear();
    s.gap.resize(0);
    s.friction.resize(0);
    const Posed posed = s.system();
    Elimination elimination;
    ASSERT_EQ(elimination.factor(*posed.problem().system, 1e9), Elimination::Outcome::done);
    EXPECT_EQ(elimination.floating().cols(), d == 2 ? 3 : 6);
  }
}

TEST(Elimination, SeparateBodiesKeepTheirContactDofsLast) {
  // the contact block of the factor is not dense
  const ContactProblem one = problem_of(BlockOptions()), two = beside(one, 2);
  Elimination single, twofold;
  ASSERT_EQ(single.factor(*one.system, 1e9), Elimination::Outcome::done);
  ASSERT_EQ(twofold.factor(*two.system, 1e9), Elimination::Outcome::done);
  const Index C = one.contact_dofs();
  EXPECT_LT((twofold.S().topLeftCorner(C, C) - single.S()).norm(), 1e-12 * single.S().norm());
  EXPECT_LT((twofold.S().bottomRightCorner(C, C) - single.S()).norm(), 1e-12 * single.S().norm());
  EXPECT_LT(twofold.S().topRightCorner(C, C).norm(), 1e-12 * single.S().norm());
}

TEST(Elimination, AsksForTheFactorAndTheDenseMatricesAndForNoByteMore) {
  BlockOptions o;
  o.cells = 8;
  const ContactProblem p = problem_of(o);
  const double dense = 3 * sizeof(Real) * std::pow(p.contact_dofs(), 2);
  Elimination open;
  ASSERT_EQ(open.factor(*p.system, 1e9), Elimination::Outcome::done);
  const double needed = open.memory_needed();
  // a factor of some fill-in: more than the lower half of A, less than a dense one
  EXPECT_GT(needed, dense + sizeof(Real) * p.system->entries().nonZeros() / 2);
  EXPECT_LT(needed, dense + sizeof(Real) * std::pow(p.dofs(), 2) / 2);
  Elimination exact, tight, tighter;
  EXPECT_EQ(exact.factor(*p.system, needed), Elimination::Outcome::done);
  EXPECT_EQ(tight.factor(*p.system, needed - 1), Elimination::Outcome::too_large);
  EXPECT_EQ(tight.memory_needed(), needed);
  EXPECT_EQ(tighter.factor(*p.system, dense - 1), Elimination::Outcome::too_large);
  EXPECT_EQ(tighter.memory_needed(), dense);
}

TEST(Elimination, ContactDofsStayInTheirOrderWhereNothingButTheirOrderChainsThem) {
  // two chains of contact nodes, one through the other, and no interior
  DenseMatrix A = DenseMatrix::Identity(8, 8) * 3;
  for (Index i = 0; i + 2 < 8; ++i) A(i, i + 2) = A(i + 2, i) = -1;
  const ByHand hand(1, A, Vector::Ones(8));
  Elimination elimination;
  ASSERT_EQ(elimination.factor(*hand.problem.system, 1e9), Elimination::Outcome::done);
  EXPECT_LT((elimination.S() - A).norm(), 1e-14);
}

TEST(Elimination, ASoftSupportIsNoRoundingOfNone) {
  for (Real spring : {1e-10, 1e-12}) {  // over the stiffness of the body
    BlockOptions o;
    o.law = Law::frictionless;
    o.shear = 0;
    Scene s = block(o);
    Real largest = 0;
    for (std::size_t k = 0; k < s.a.size(); ++k)
      if (s.i[k] == s.j[k]) largest = std::max(largest, s.a[k]);
    const Index sideways = Index(s.b.size()) - 2;  // of the last node, on top
    s.i.push_back(sideways);
    s.j.push_back(sideways);
    s.a.push_back(spring * largest);
    const Posed posed = s.system();
    Elimination elimination;
    ASSERT_EQ(elimination.factor(*posed.problem().system, 1e9), Elimination::Outcome::done)
        << spring;
    EXPECT_EQ(elimination.floating().cols(), 0) << spring;
  }
}

TEST(Elimination, TheLastInteriorDofOfEachBodyIsKnown) {
  const ContactProblem one = problem_of(BlockOptions()), three = beside(one, 3);
  std::vector<Index> order(three.dofs());
  std::iota(order.begin(), order.end(), 0);
  const Index I = one.interior();
  EXPECT_EQ(last_of_each_part(*three.system, order),
            (std::vector<Index>{3 * I - 1, 2 * I - 1, I - 1}));
}

TEST(Elimination, NegativeEnergyThatContactBlocksIsInSWhileAShiftOutweighsIt) {
  for (Real a : {1.7, 8.0, 30.0}) {
    DenseMatrix A(2, 2);
    A << 1, a, a, 1;
    ByHand hand(1, A, Vector::Ones(2));
    AssembledSystem system = assembled(hand.problem.system);
    system.first = {1, 2};
    Elimination elimination;
    const auto outcome = elimination.factor(system, 1e9);
    ASSERT_EQ(outcome,
              a < 30 ? Elimination::Outcome::done : Elimination::Outcome::not_positive_definite);
    if (a == 30) continue;
    EXPECT_NEAR(elimination.S()(0, 0), 1 - a * a, 1e-12);
    EXPECT_EQ(elimination.floating().cols(), 0);
  }
}

TEST(Elimination, AnIndefiniteMatrixHasNone) {
  const ContactProblem p = problem_of(BlockOptions());
  AssembledSystem bad = assembled(p.system);
  bad.A.coeffRef(3, 3) *= -1;
  bad.D[3] *= -1;
  Elimination elimination;
  EXPECT_EQ(elimination.factor(bad, 1e9), Elimination::Outcome::not_positive_definite);
}
