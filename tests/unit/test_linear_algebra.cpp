// Decompositions of dense matrices, by what defines them.
#include <gtest/gtest.h>

#include "core/factorization.h"
#include "core/linear_algebra.h"

using namespace frictioncg;

namespace {

/// Rows in general position, and a last column that is the sum of the others.
DenseMatrix dependent(Index rows, Index columns) {
  DenseMatrix A(rows, columns);
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j) A(i, j) = std::sin(1 + 3 * i + 7 * j * j + i * j);
  A.rightCols(1) = A.leftCols(columns - 1).rowwise().sum();
  return A;
}

DenseMatrix positive(Index n) {
  const DenseMatrix A = dependent(n, n);
  return A * A.transpose() + DenseMatrix::Identity(n, n);
}

}  // namespace

TEST(LinearAlgebra, LeastSquaresLeaveAnOrthogonalRestAndHaveTheLeastNorm) {
  const DenseMatrix A = dependent(6, 4), B = dependent(6, 2);
  const DenseMatrix X = least_squares(A, B), kernel = null_space(A, 1e-12);
  EXPECT_LE((A.transpose() * (A * X - B)).norm(), 1e-13);
  ASSERT_EQ(kernel.cols(), 1);
  EXPECT_LE((kernel.transpose() * X).norm(), 1e-13);
  EXPECT_NE(least_squares(A, B, 0.5), X);  // more of A counts as 0
}

TEST(LinearAlgebra, TheNullSpaceIsOrthonormalAlsoOfFewRows) {
  for (Index rows : {2, 4, 9}) {
    const DenseMatrix A = dependent(rows, 4), V = null_space(A, 1e-12);
    EXPECT_EQ(V.cols(), rows == 2 ? 2 : 1);
    EXPECT_LE((A * V).norm(), 1e-13);
    EXPECT_LE((V.transpose() * V - DenseMatrix::Identity(V.cols(), V.cols())).norm(), 1e-14);
  }
}

TEST(LinearAlgebra, TheNullSpaceIsWhatTheToleranceLeaves) {
  const DenseMatrix A = Eigen::Vector3d(1, 2e-9, 0.5e-9).asDiagonal();
  EXPECT_EQ(null_space(A, 1e-9).cols(), 1);
  EXPECT_EQ(null_space(DenseMatrix::Zero(2, 3), 0).cols(), 3);
}

TEST(LinearAlgebra, TheTriangleHasTheProductsOfTheColumns) {
  for (Index rows : {2, 5}) {
    const DenseMatrix A = dependent(rows, 3), R = triangle(A);
    EXPECT_LE((R.transpose() * R - A.transpose() * A).norm(), 1e-13);
    EXPECT_EQ(R(1, 0), 0);
  }
  const DenseMatrix A = dependent(5, 4).leftCols(3), Q = orthonormal(A);
  EXPECT_LE((Q.transpose() * Q - DenseMatrix::Identity(3, 3)).norm(), 1e-14);
  EXPECT_LE((Q * (Q.transpose() * A) - A).norm(), 1e-13);
}

TEST(LinearAlgebra, EigenpairsAscendAndAreNormalInTheGivenProduct) {
  const DenseMatrix A = positive(4) - 2 * DenseMatrix::Identity(4, 4), M = 3 * positive(4);
  const Eigenpairs plain = eigenpairs(A), general = eigenpairs(A, M);
  EXPECT_LE((A * plain.vectors - plain.vectors * plain.values.asDiagonal()).norm(), 1e-13);
  EXPECT_LE((A * general.vectors - M * general.vectors * general.values.asDiagonal()).norm(),
            1e-12);
  EXPECT_LE(
      (general.vectors.transpose() * M * general.vectors - DenseMatrix::Identity(4, 4)).norm(),
      1e-13);
  for (Index k = 1; k < 4; ++k) EXPECT_LE(general.values[k - 1], general.values[k]);
}

TEST(LinearAlgebra, SolvesGradedMatricesAndWhatASingularOneLeaves) {
  Vector grades(4);
  grades << 1, 1e-2, 1e-5, 1e-7;
  const DenseMatrix A = grades.asDiagonal() * positive(4) * grades.asDiagonal();
  const DenseMatrix I = DenseMatrix::Identity(4, 4), singular = dependent(4, 4);
  EXPECT_LE((solve(A, A) - I).norm(), 1e-7);  // of columns that differ by 1e7
  EXPECT_LE((singular * solve(singular, singular) - singular).norm(), 1e-13);
  EXPECT_GE((singular * solve(singular, I) - I).norm(), 1);
}

TEST(LinearAlgebra, FactorsSolveAndTellASingularMatrix) {
  const DenseMatrix A = positive(4), B = dependent(4, 2);
  DenseMatrix in_place = A, indefinite = -A, singular = dependent(4, 4), turned = A;
  const Cholesky factor(in_place);
  ASSERT_TRUE(factor.found());
  EXPECT_LE((A * factor.solve(B) - B).norm(), 1e-13);
  EXPECT_GT(factor.rcond(), 1e-3);
  EXPECT_FALSE(Cholesky(indefinite).found());
  turned.row(0).swap(turned.row(3));
  DenseMatrix factored = turned;
  EXPECT_LE((turned * LU(factored).solve(B.col(0)) - B.col(0)).norm(), 1e-13);
  EXPECT_LT(LU(singular).rcond(), 1e-14);
}

TEST(LinearAlgebra, ADirectionIsNegativeWhereThereIsOne) {
  for (Index n : {1, 2, 7}) {
    DenseMatrix A = positive(n);
    EXPECT_EQ(negative_direction(A).size(), 0);
    const Eigenpairs of_A = eigenpairs(A);
    for (Real shift : {1e-6, 0.5}) {  // one eigenvalue below 0, and half of them
      const Real at = shift < 0.1 ? of_A.values[0] * (1 + shift) : of_A.values[n / 2] + shift;
      const DenseMatrix M = A - at * DenseMatrix::Identity(n, n);
      const Vector p = negative_direction(M);
      ASSERT_EQ(p.size(), n);
      EXPECT_LT(p.dot(M * p), 0);
    }
  }
  // a rigid motion is none, and hides none behind it
  DenseMatrix M = DenseMatrix::Zero(4, 4);
  M.topLeftCorner(2, 2) << 1, -1, -1, 1;
  EXPECT_EQ(negative_direction(M).size(), 0);
  M.bottomRightCorner(2, 2) << 1, 2, 2, 1;
  DenseMatrix saddle(3, 3), behind(3, 3);  // whose pivots are 0
  saddle << 0, 1, 0, 1, 0, 0, 0, 0, 5;
  behind << 1, 1, 0, 1, 1, 1, 0, 1, 5;
  for (const DenseMatrix& A : {M, saddle, behind}) {
    const Vector p = negative_direction(A);
    ASSERT_EQ(p.size(), A.rows());
    EXPECT_LT(p.dot(A * p), -0.1);
  }
}
