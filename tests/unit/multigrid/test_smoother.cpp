#include "core/multigrid/smoother.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/multigrid/exact_matrix.h"
#include "core/multigrid/prolongation.h"

using namespace frictioncg;

namespace {

constexpr Real single_precision = 1e-5;

/// Rows each coupled with two before: the blocks, and vectors, are random; diagonally dominant.
template <int B>
SymmetricBlocks<B> random_blocks(Index rows) {
  SymmetricBlocks<B> A;
  A.parts.first = {0, rows};
  for (Index i = 0; i < rows; ++i) {
    for (const Index j : {i - 3, i - 1})
      if (j >= 0) A.col.push_back(j);
    A.row.push_back(Index(A.col.size()));
  }
  const Eigen::VectorXf value = Eigen::VectorXf::Random(Eigen::Index(A.col.size()) * B * B);
  A.value.assign(value.begin(), value.end());
  A.inverse.assign(std::size_t(rows) * B * B, 0);
  for (Index i = 0; i < rows; ++i) {
    const Eigen::MatrixXf R = Eigen::MatrixXf::Random(B, B);
    const Eigen::MatrixXf D = 8 * Eigen::MatrixXf::Identity(B, B) + R + R.transpose();
    A.diagonal.insert(A.diagonal.end(), D.data(), D.data() + D.size());
  }
  for (Index i = 0; i < rows; ++i) invert_diagonal(A, i);
  return A;
}

/// A vector by rows of `stride` floats; what lies between rows is `between`.
template <int B>
std::vector<float> in_rows(const Vector& x, float between) {
  std::vector<float> v(std::size_t(x.size()) / B * stride<B>, between);
  for (Eigen::Index p = 0; p < x.size(); ++p) v[p / B * stride<B> + p % B] = float(x[p]);
  return v;
}
template <int B>
Vector of_rows(const std::vector<float>& v) {
  Vector x(Eigen::Index(v.size() / stride<B> * B));
  for (Eigen::Index p = 0; p < x.size(); ++p) x[p] = v[p / B * stride<B> + p % B];
  return x;
}

/// The diagonal blocks of A and what lies below them.
template <int B>
Eigen::MatrixXd lower_part(const Eigen::MatrixXd& A) {
  Eigen::MatrixXd L = A.triangularView<Eigen::Lower>();
  for (Eigen::Index k = 0; k < A.rows(); k += B) L.block<B, B>(k, k) = A.block<B, B>(k, k);
  return L;
}

template <int B>
void check_sweeps() {
  const SymmetricBlocks<B> A = random_blocks<B>(9);
  const Eigen::MatrixXd M = dense(A), L = lower_part<B>(M);
  const Vector r = Vector::Random(M.rows()), start = Vector::Random(M.rows());
  // what lies between rows means nothing in residuals
  std::vector<float> residual = in_rows<B>(r, 7), z = in_rows<B>(start, 7);
  sweep_forward(A, residual.data(), z.data());
  const Vector forward = L.partialPivLu().solve(r);
  EXPECT_LT((of_rows<B>(z) - forward).norm(), single_precision) << B;
  EXPECT_LT((of_rows<B>(residual) - (r - M * forward)).norm(), single_precision) << B;

  std::vector<float> rest = in_rows<B>(r, 7);
  z = in_rows<B>(start, 0);
  sweep_backward(A, rest.data(), z.data());
  const Vector backward = L.transpose().partialPivLu().solve(r - (M - L.transpose()) * start);
  EXPECT_LT((of_rows<B>(z) - backward).norm(), single_precision) << B;

  z = in_rows<B>(start, 0);
  subtract_product(A, in_rows<B>(r, 7).data(), z.data(), residual.data());
  EXPECT_LT((of_rows<B>(residual) - (r - M * start)).norm(), single_precision) << B;
}

template <int R, int C>
void check_transfer(Index rows) {
  Prolongation<R, C> P;
  P.columns = 3;
  for (Index i = 0; i < rows; ++i) {
    P.col.insert(P.col.end(), {i % 2, 2});
    P.row.push_back(Index(P.col.size()));
  }
  const Eigen::VectorXf value = Eigen::VectorXf::Random(Eigen::Index(P.col.size()) * R * C);
  P.value.assign(value.begin(), value.end());
  const Eigen::MatrixXd M = dense(P);
  const Vector fine = Vector::Random(M.rows()), coarse = Vector::Random(M.cols());
  std::vector<std::vector<float>> restricted;
  for (Index threads : {1, 3}) {
    const Threads given(threads);
    std::vector<float> sums;
    std::vector<float>& v = restricted.emplace_back(in_rows<C>(coarse, 7));
    with_threads([&] { restrict_to(P, in_rows<R>(fine, 7).data(), v, sums); });
  }
  const Vector sum = M.transpose() * fine;
  EXPECT_LT((of_rows<C>(restricted[0]) - sum).norm(), single_precision * sum.norm()) << R << C;
  EXPECT_EQ(restricted[0], restricted[1]);
  std::vector<float> v = in_rows<R>(fine, 0);
  prolong(P, in_rows<C>(coarse, 0).data(), v.data());
  EXPECT_LT((of_rows<R>(v) - (fine + M * coarse)).norm(), single_precision * std::sqrt(rows))
      << R << C;
}

}  // namespace

TEST(Smoother, SweepsAreGaussSeidelByBlocks) {
  check_sweeps<2>();
  check_sweeps<3>();
  check_sweeps<6>();
}

TEST(Smoother, GoesFromLevelToLevelByTheProlongation) {
  for (Index rows : {5, 20000}) {  // the latter in ranges
    check_transfer<2, 3>(rows);
    check_transfer<3, 3>(rows);
    check_transfer<3, 6>(rows);
    check_transfer<6, 6>(rows);
  }
}
