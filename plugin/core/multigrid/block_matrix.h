#pragma once
#include <algorithm>
#include <cstddef>

#include "types.h"

namespace frictioncg {

// Sparse matrices of small dense blocks in single precision. Sizes are known when compiled, so that
// each block operation is a few unrolled instructions. Blocks are stored by rows.

/// y += a x
template <int R, int C>
inline void add_product(const float* a, const float* x, float* y) {
  for (int r = 0; r < R; ++r) {
    float sum = a[r * C] * x[0];
    for (int c = 1; c < C; ++c) sum += a[r * C + c] * x[c];
    y[r] += sum;
  }
}

/// y += a' x
template <int R, int C>
inline void add_transposed_product(const float* a, const float* x, float* y) {
  for (int c = 0; c < C; ++c) {
    float sum = a[c] * x[0];
    for (int r = 1; r < R; ++r) sum += a[r * C + c] * x[r];
    y[c] += sum;
  }
}

/// c += factor a b, with a R x K and b K x C
template <int R, int K, int C>
inline void add_block_product(float factor, const float* a, const float* b, float* c) {
  for (int r = 0; r < R; ++r)
    for (int k = 0; k < K; ++k) {
      const float f = factor * a[r * K + k];
      for (int j = 0; j < C; ++j) c[r * C + j] += f * b[k * C + j];
    }
}

/// c += factor a' b, with a K x R and b K x C
template <int R, int K, int C>
inline void add_transposed_block_product(float factor, const float* a, const float* b, float* c) {
  for (int k = 0; k < K; ++k)
    for (int r = 0; r < R; ++r) {
      const float f = factor * a[k * R + r];
      for (int j = 0; j < C; ++j) c[r * C + j] += f * b[k * C + j];
    }
}

/// A symmetric matrix by its strictly lower blocks, row by row, and its diagonal blocks. Half of
/// the storage, and a sweep that uses each block in both places reads half as much.
template <int B>
struct SymmetricBlocks {
  static constexpr int size = B;
  static constexpr int entries = B * B;
  std::vector<Index> row{0};    ///< rows + 1, into col
  std::vector<Index> col;       ///< sorted in each row, col < row
  std::vector<float> value;     ///< entries per col
  std::vector<float> diagonal;  ///< entries per row
  std::vector<float> inverse;   ///< of the diagonal blocks, 0 on slots that are fixed or empty

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
  std::vector<Index> col;     ///< sorted in each row
  std::vector<float> value;   ///< entries per col
  Index columns = 0;

  Index rows() const { return static_cast<Index>(row.size()) - 1; }
  float* at(std::size_t k) { return value.data() + k * entries; }
  const float* at(std::size_t k) const { return value.data() + k * entries; }
};

}  // namespace frictioncg
