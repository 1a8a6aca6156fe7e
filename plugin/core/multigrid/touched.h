#pragma once
#include "multigrid/prolongation.h"

namespace frictioncg {

/// The blocks of a coarse matrix that contact dofs contribute to, A = base + contact part: only
/// they change with the faces. The rows own their diagonal block and some of their lower blocks.
template <int B>
struct Touched {
  std::vector<Index> rows;
  std::vector<Index> begin{0};  ///< rows + 1, into lower
  std::vector<Index> lower;     ///< indices of stored blocks

  /// What P' X P reaches, X being the blocks `finer` of A.
  template <int R>
  static Touched reached(const SymmetricBlocks<R>& A, const Touched<R>& finer,
                         const Prolongation<R, B>& P, const SymmetricBlocks<B>& coarse) {
    std::vector<char> row_hit(coarse.rows(), 0), lower_hit(coarse.col.size(), 0);
    std::vector<Index> columns, seen_by(coarse.rows(), -1);
    for (std::size_t q = 0; q < finer.rows.size(); ++q) {
      const Index i = finer.rows[q];
      columns.clear();
      const auto visit = [&](Index j) {
        for (Index c = P.row[j]; c < P.row[j + 1]; ++c)
          if (seen_by[P.col[c]] != i) seen_by[P.col[c]] = i, columns.push_back(P.col[c]);
      };
      visit(i);
      for (Index k = finer.begin[q]; k < finer.begin[q + 1]; ++k) visit(A.col[finer.lower[k]]);
      for (Index c = P.row[i]; c < P.row[i + 1]; ++c)
        for (const Index J : columns) {
          const Index I = P.col[c];
          row_hit[I] = row_hit[J] = 1;
          if (I != J) lower_hit[coarse.find(std::max(I, J), std::min(I, J))] = 1;
        }
    }
    Touched t;
    for (Index I = 0; I < coarse.rows(); ++I) {
      if (!row_hit[I]) continue;
      t.rows.push_back(I);
      for (Index k = coarse.row[I]; k < coarse.row[I + 1]; ++k)
        if (lower_hit[k]) t.lower.push_back(k);
      t.begin.push_back(to_block_index(t.lower.size()));
    }
    return t;
  }

  std::vector<float> read(const SymmetricBlocks<B>& A) const {
    std::vector<float> values((rows.size() + lower.size()) * B * B);
    for_each_block(A, [&](const float* a, std::size_t offset) {
      std::copy(a, a + B * B, values.begin() + offset);
    });
    return values;
  }
  /// A := factor A + values on these blocks
  void add(float factor, const std::vector<float>& values, SymmetricBlocks<B>& A) const {
    for_each_block(A, [&](float* a, std::size_t offset) {
      for (int e = 0; e < B * B; ++e) a[e] = factor * a[e] + values[offset + e];
    });
  }
  void clear(SymmetricBlocks<B>& A) const {
    for_each_block(A, [&](float* a, std::size_t) { std::fill(a, a + B * B, 0.0f); });
  }

 private:
  /// visit(pointer into A, offset into a compact copy)
  template <class Blocks, class Visit>
  void for_each_block(Blocks& A, Visit visit) const {
    std::size_t offset = 0;
    for (const Index i : rows) {
      visit(A.diagonal_at(i), offset);
      offset += B * B;
    }
    for (const Index k : lower) {
      visit(A.at(k), offset);
      offset += B * B;
    }
  }
};

}  // namespace frictioncg
