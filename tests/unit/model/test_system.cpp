#include <gtest/gtest.h>

#include "core/model/contact_problem.h"

using namespace frictioncg;

namespace {

/// Interior dofs with the diagonal 1, 3, 8; contact nodes (N, T1, T2) with 5, 2, 4 and (N) with 7.
AssembledSystem small(std::vector<Index> mesh_node) {
  AssembledSystem s;
  s.dimension = 3;
  s.D.resize(7);
  s.D << 1, 3, 8, 5, 2, 4, 7;
  s.first = {3, 6, 7};
  s.mesh_node = std::move(mesh_node);
  s.weight = node_weights(s);
  return s;
}

/// Every other entry is 0.
Matrix sparse_random(Index rows, Index columns) {
  DenseMatrix M = DenseMatrix::Random(rows, columns);
  for (Index k = 0; k < M.size(); k += 2) M.data()[k] = 0;
  return M.sparseView();
}

}  // namespace

TEST(System, CountsItsDofsNodesAndTangents) {
  const AssembledSystem s = small({});
  EXPECT_EQ(s.dofs(), 7);
  EXPECT_EQ(s.nodes(), 2);
  EXPECT_EQ(s.interior(), 3);
  EXPECT_EQ(s.contact_dofs(), 4);
  EXPECT_EQ(s.tangents(0), 2);
  EXPECT_EQ(s.tangents(1), 0);
}

TEST(System, InteriorDofsOfAMeshNodeShareTheirMeanDiagonal) {
  const Vector w = small({4, 4, 0, 1, 1, 1, 2}).weight;
  EXPECT_EQ(w[0], 2);
  EXPECT_EQ(w[1], 2);
  EXPECT_EQ(w[2], 8);
}

TEST(System, WithoutMeshNodesEachInteriorDofHasItsOwnWeight) {
  const AssembledSystem s = small({});
  EXPECT_EQ(s.weight.head(3), s.D.head(3));
}

TEST(System, AContactNodeHasOneWeightAlongItsNormalAndOneAcross) {
  for (const AssembledSystem& s : {small({}), small({4, 4, 0, 4, 4, 4, 0})}) {
    EXPECT_EQ(s.weight[3], 5);
    EXPECT_EQ(s.weight[4], 3);
    EXPECT_EQ(s.weight[5], 3);
    EXPECT_EQ(s.weight[6], 7);
  }
}

TEST(System, WithoutInteriorTheWeightsAreThoseOfTheContactNodes) {
  AssembledSystem s;
  s.D = Vector::Constant(2, 6);
  s.first = {0, 2};
  s.mesh_node = {0, 0};
  EXPECT_EQ(node_weights(s), s.D);
}

/// A chain of interior dofs with springs k between them and one contact dof, held at its first one.
AssembledSystem chain(const Vector& k, Real support) {
  const Index n = static_cast<Index>(k.size()) + 1;
  DenseMatrix A = DenseMatrix::Zero(n, n);
  for (Index i = 0; i + 1 < n; ++i)
    for (Index a : {i, i + 1})
      for (Index b : {i, i + 1}) A(a, b) += a == b ? k[i] : -k[i];
  A(0, 0) += support;
  AssembledSystem s;
  s.dimension = 2;
  s.A = A.sparseView();
  s.D = A.diagonal();
  s.first = {n - 1, n};
  s.rigid_modes = [n] { return DenseMatrix(DenseMatrix::Ones(n, 1)); };
  s.weight = node_weights(s);
  return s;
}

TEST(System, APenaltyCountsByTheDisplacementThatItLetsThrough) {
  const Real most = 1e6 * 2;  // over the median of 2
  for (const Real support : {1e11, 1e20, 1e79}) {
    const AssembledSystem s = chain(Vector::Ones(6), support);
    EXPECT_NEAR(s.weight[0] / std::min(support * (support / most), 1e80), 1, 1e-10);
    EXPECT_EQ(s.weight.tail(6), s.D.tail(6));
  }
}

TEST(System, AStiffInclusionIsNoPenaltyNorWhatIsBesideOne) {
  Vector k = Vector::Ones(10);
  k.segment(3, 2).setConstant(1e13);
  for (const Real support : {0., 1., 1e20}) {
    const AssembledSystem s = chain(k, support);
    EXPECT_EQ(s.weight.tail(10), s.D.tail(10)) << support;
  }
}

TEST(System, ContrastIsThatOfPartsAndNotOfPenalties) {
  Vector k = Vector::Ones(10);
  k.segment(3, 2).setConstant(1e13);
  for (const Real support : {0., 1., 1e20}) {
    EXPECT_NEAR(contrast(chain(k, support)), 2e13, 1e3) << support;
    EXPECT_EQ(contrast(chain(Vector::Ones(10), support)), 2) << support;
  }
  EXPECT_EQ(contrast(AssembledSystem()), 1);
}

TEST(System, WithoutRigidMotionsNoPenaltyIsTold) {
  AssembledSystem s = chain(Vector::Ones(6), 1e20);
  s.rigid_modes = {};
  EXPECT_EQ(node_weights(s), s.D);
}

TEST(System, DofsThatAPenaltyCouplesStronglyAreHeldWithIt) {
  AssembledSystem s = chain(Vector::Ones(6), 1e20);
  s.A.coeffRef(1, 1) += 1e20;  // as rows of a trace's mass that sum up to 0
  s.A.coeffRef(0, 1) = s.A.coeffRef(1, 0) = -1e20;
  s.A.coeffRef(0, 0) += 1e20;
  s.D = s.A.diagonal();
  const Vector w = node_weights(s);
  EXPECT_GT(w[0], 1e28);
  EXPECT_GT(w[1], 1e28);
  EXPECT_EQ(w.tail(5), s.D.tail(5));
}

TEST(System, TheRowsOfAProductAreThoseOfItsColumns) {
  const AssembledSystem s = chain(Vector::Ones(6), 3);
  for (const Index columns : {1, 3, 8, 12}) {
    const Matrix M = sparse_random(s.dofs(), columns);
    const DenseMatrix expected = s.A * DenseMatrix(M);
    for (const bool by_rows : {true, false}) {
      DenseMatrix AM = DenseMatrix::Zero(s.dofs(), columns);
      const VisitRow visit = [&](Index i, const std::vector<Index>& some, const Vector& values) {
        for (Index j : some) AM(i, j) += values[j];
      };
      if (by_rows) s.product(M, visit);
      if (!by_rows) s.System::product(M, visit);
      EXPECT_LT((AM - expected).norm(), 1e-14 * expected.norm());
    }
  }
}

TEST(System, ResidualsAreMeasuredOverTheRootOfTheWeight) {
  const AssembledSystem s = small({4, 4, 0, 1, 1, 1, 2});
  Vector r = Vector::Zero(7);
  r[0] = 2;
  r[5] = 3;
  EXPECT_DOUBLE_EQ(norm_D(s, r), std::sqrt(4.0 / 2 + 9.0 / 3));
}

TEST(System, WhatDrivesAnIncrementIsItsLoadOrItsPenetration) {
  const AssembledSystem s = small({});
  Increment i;
  i.F = Vector::Zero(7);
  i.gap = Vector::Zero(2);
  EXPECT_EQ(driving_norm(s, i), 0);
  i.gap << 1, -2;
  EXPECT_DOUBLE_EQ(driving_norm(s, i), std::sqrt(7.0) * 2);
  i.bilateral = true;
  EXPECT_DOUBLE_EQ(driving_norm(s, i), std::sqrt(5.0 + 7 * 4));
  i.F[1] = 3;
  EXPECT_DOUBLE_EQ(driving_norm(s, i), std::sqrt(3.0));
}
