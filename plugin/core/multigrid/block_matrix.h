#pragma once
#include <cstddef>
#include <type_traits>

#include "multigrid/lanes.h"
#include "multigrid/parts.h"

namespace frictioncg {

// Sparse matrices of small dense blocks in single precision. Sizes are known when compiled, so that
// each block operation is a few unrolled instructions. Blocks are stored by rows; those of 3 x 3,
// and all with rows of six, are multiplied in lanes. Vectors have `stride` floats a row.

/// How many blocks, slots or couplings of blocks there are, as what indexes them. Throws
/// IllegalInput beyond 2^31 - 1. Entries are counted by 64 bits: a block has up to 36 of them.
inline Index to_block_index(std::size_t count) {
  if (count > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    refuse("a level of the multigrid hierarchy has ", count,
           " blocks, more than 2^31 - 1; this build indexes them by 32 bits: take "
           "method=\"GCX\" with precon=\"ssor\"");
  return static_cast<Index>(count);
}

/// Whether R x C blocks fill lanes.
template <int R, int C>
constexpr bool in_lanes = C == 6 || (R == 3 && C == 3);

/// The sum of a x over blocks a, R x C, and rows x of a vector; lanes are summed up once, at the
/// end.
template <int R, int C>
class BlockSum {
 public:
  void add(const float* a, const float* x) {
    if constexpr (C == 6) {
      const Four head = load<Four>(x), tail{0, 0, x[4], x[5]};
      for (int r = 0; r < R; ++r)
        sum_[r] += load<Four>(row_of<6>(a, r)) * head + load<Four>(row_of<6>(a, r) + 2) * tail;
    } else if constexpr (in_lanes<R, C>) {
      const Four v = load<Four>(x);
      for (int r = 0; r < R; ++r) sum_[r] += row_of_three(a, r) * v;
    } else {
      for (int r = 0; r < R; ++r)
        for (int c = 0; c < C; ++c) sum_[r] += a[r * C + c] * x[c];
    }
  }
  /// Row r of the sum
  float operator[](int r) const {
    if constexpr (in_lanes<R, C>)
      return (sum_[r][0] + sum_[r][1]) + (sum_[r][2] + sum_[r][3]);
    else
      return sum_[r];
  }

 private:
  std::conditional_t<in_lanes<R, C>, Four, float> sum_[R] = {};
};

/// y += a' x, with a R x C
template <int R, int C>
inline void add_transposed_product(const float* a, const float* x, float* y) {
  if constexpr (C == 6) {
    Six sum = Six::load(y);
    for (int r = 0; r < R; ++r) sum.add(x[r], Six::load(row_of<6>(a, r)));
    sum.store(y);
  } else if constexpr (in_lanes<R, C>) {
    Four sum = load<Four>(y);
    for (int r = 0; r < R; ++r) sum += x[r] * row_of_three(a, r);
    store(y, sum);
  } else {
    for (int r = 0; r < R; ++r)
      for (int c = 0; c < C; ++c) y[c] += a[r * C + c] * x[r];
  }
}

/// c += a b, with b K x C, and a R x K, whose entry (r, k) is factor a[r * row + k * column]
template <int R, int K, int C>
inline void add_rows(float factor, const float* a, int row, int column, const float* b, float* c) {
  if constexpr (C == 6) {
    Six rows[K];
    for (int k = 0; k < K; ++k) rows[k] = Six::load(row_of<6>(b, k));
    for (int r = 0; r < R; ++r) {
      Six sum = Six::load(row_of<6>(c, r));
      for (int k = 0; k < K; ++k) sum.add(factor * a[r * row + k * column], rows[k]);
      sum.store(row_of<6>(c, r));
    }
  } else {
    for (int r = 0; r < R; ++r)
      for (int k = 0; k < K; ++k) {
        const float f = factor * a[r * row + k * column];
        for (int j = 0; j < C; ++j) c[r * C + j] += f * b[k * C + j];
      }
  }
}

/// c += factor a b, with a R x K and b K x C
template <int R, int K, int C>
inline void add_block_product(float factor, const float* a, const float* b, float* c) {
  add_rows<R, K, C>(factor, a, K, 1, b, c);
}

/// c += a' b, with a K x R and b K x C
template <int R, int K, int C>
inline void add_transposed_block_product(const float* a, const float* b, float* c) {
  add_rows<R, K, C>(1, a, 1, R, b, c);
}

/// A symmetric matrix by its strictly lower blocks, row by row, and its diagonal blocks. Half of
/// the storage, and a sweep that uses each block in both places reads half as much.
template <int B>
struct SymmetricBlocks {
  static constexpr int entries = B * B;
  std::vector<Index> row{0};    ///< rows + 1, into col
  std::vector<Index> col;       ///< sorted in each row, col < row
  std::vector<float> value;     ///< entries per col
  std::vector<float> diagonal;  ///< entries per row
  std::vector<float> inverse;   ///< of the diagonal blocks, 0 on slots that are fixed or empty
  Parts parts;                  ///< of the rows, for sweeps

  Index rows() const { return static_cast<Index>(row.size()) - 1; }
  float* at(std::size_t k) { return value.data() + k * entries; }
  const float* at(std::size_t k) const { return value.data() + k * entries; }
  float* diagonal_at(std::size_t i) { return diagonal.data() + i * entries; }
  const float* diagonal_at(std::size_t i) const { return diagonal.data() + i * entries; }
  const float* inverse_at(std::size_t i) const { return inverse.data() + i * entries; }
  /// Where block (i, j), j < i, is stored; it must be there.
  Index find(Index i, Index j) const {
    return static_cast<Index>(std::lower_bound(col.begin() + row[i], col.begin() + row[i + 1], j) -
                              col.begin());
  }
};

/// A prolongation: R x C blocks, by rows; columns are blocks of the coarse level.
template <int R, int C>
struct Prolongation {
  static constexpr int entries = R * C;
  std::vector<Index> row{0};  ///< rows + 1, into col
  std::vector<Index> col;     ///< in each row in any order
  std::vector<float> value;   ///< entries per col
  Index columns = 0;

  Index rows() const { return static_cast<Index>(row.size()) - 1; }
  float* at(std::size_t k) { return value.data() + k * entries; }
  const float* at(std::size_t k) const { return value.data() + k * entries; }
};

/// Both halves of A, by slots.
template <int B>
Eigen::MatrixXd dense(const SymmetricBlocks<B>& A) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(Eigen::Index(A.rows()) * B, Eigen::Index(A.rows()) * B);
  using Block = Eigen::Map<const Eigen::Matrix<float, B, B, Eigen::RowMajor>>;
  for (Index i = 0; i < A.rows(); ++i) {
    M.template block<B, B>(i * B, i * B) = Block(A.diagonal_at(i)).template cast<Real>();
    for (Index k = A.row[i]; k < A.row[i + 1]; ++k) {
      const auto a = Block(A.at(k)).template cast<Real>();
      M.template block<B, B>(i * B, A.col[k] * B) = a;
      M.template block<B, B>(A.col[k] * B, i * B) = a.transpose();
    }
  }
  return M;
}

template <int R, int C>
Eigen::MatrixXd dense(const Prolongation<R, C>& P) {
  Eigen::MatrixXd M =
      Eigen::MatrixXd::Zero(Eigen::Index(P.rows()) * R, Eigen::Index(P.columns) * C);
  for (Index i = 0; i < P.rows(); ++i)
    for (Index q = P.row[i]; q < P.row[i + 1]; ++q)
      M.template block<R, C>(i * R, P.col[q] * C) =
          Eigen::Map<const Eigen::Matrix<float, R, C, Eigen::RowMajor>>(P.at(q))
              .template cast<Real>();
  return M;
}

/// What vectors keep in memory.
template <class... T>
double bytes_of(const std::vector<T>&... v) {
  return (0.0 + ... + (double(v.capacity()) * sizeof(T)));
}

// X of the sizes that levels have, and of those of the prolongations between them.
#define FRICTIONCG_BLOCKS(X) X(2) X(3) X(6)
#define FRICTIONCG_PROLONGATIONS(X) X(2, 3) X(3, 3) X(3, 6) X(6, 6)

}  // namespace frictioncg
