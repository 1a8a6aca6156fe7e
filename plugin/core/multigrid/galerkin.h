#pragma once
#include "multigrid/prolongation.h"

namespace frictioncg {

/// Some rows of a matrix, each with its diagonal block and some of its lower blocks. Contact dofs
/// contribute to few blocks of a coarse matrix, A = base + contact part: only they change with the
/// faces.
template <int B>
struct Touched {
  std::vector<Index> rows;
  std::vector<Index> begin{0};  ///< rows + 1, into lower
  std::vector<Index> lower;     ///< indices of stored blocks

  static Touched all(const SymmetricBlocks<B>& A) {
    Touched t{std::vector<Index>(A.rows()), A.row, std::vector<Index>(A.col.size())};
    std::iota(t.rows.begin(), t.rows.end(), 0);
    std::iota(t.lower.begin(), t.lower.end(), 0);
    return t;
  }
  /// Whose pairs of coarse rows P' X P fills, X being these blocks of A: visit(I, J), perhaps more
  /// than once.
  template <int C, class Visit>
  void for_each_reached(const SymmetricBlocks<B>& A, const Prolongation<B, C>& P,
                        const Visit& visit) const {
    std::vector<Index> columns, seen_by(P.columns, -1);
    for (std::size_t q = 0; q < rows.size(); ++q) {
      const Index i = rows[q];
      columns.clear();
      const auto reach = [&](Index j) {
        for (Index c = P.row[j]; c < P.row[j + 1]; ++c)
          if (std::exchange(seen_by[P.col[c]], i) != i) columns.push_back(P.col[c]);
      };
      reach(i);
      for (Index k = begin[q]; k < begin[q + 1]; ++k) reach(A.col[lower[k]]);
      for (Index c = P.row[i]; c < P.row[i + 1]; ++c)
        for (const Index J : columns) visit(P.col[c], J);
    }
  }
  /// The blocks of the coarse matrix that P' X P fills.
  template <int C>
  Touched<C> reached(const SymmetricBlocks<B>& A, const Prolongation<B, C>& P,
                     const SymmetricBlocks<C>& coarse) const {
    std::vector<char> row_hit(coarse.rows(), 0), lower_hit(coarse.col.size(), 0);
    for_each_reached(A, P, [&](Index I, Index J) {
      row_hit[I] = row_hit[J] = 1;
      if (I != J) lower_hit[coarse.find(std::max(I, J), std::min(I, J))] = 1;
    });
    Touched<C> t;
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

/// Of each row of a level, B rows of its near-kernel, and where it lies.
template <int B>
struct Grid {
  Modes<B> modes;
  Eigen::MatrixXd place;  ///< rows x dimension

  /// Row i becomes number[i].
  void renumber(const std::vector<Index>& number) {
    const Grid old = *this;
    for (std::size_t i = 0; i < number.size(); ++i) {
      place.row(number[i]) = old.place.row(Index(i));
      modes.template middleRows<B>(Eigen::Index(number[i]) * B) =
          old.modes.template middleRows<B>(Eigen::Index(i) * B);
    }
  }
};

/// The places of P' A P, zero, in parts. all: blocks of A. The columns of P, at `place`, become the
/// rows `number`.
template <int B, int K>
SymmetricBlocks<K> galerkin_pattern(const SymmetricBlocks<B>& A, const Touched<B>& all,
                                    const Prolongation<B, K>& P, const Eigen::MatrixXd& place,
                                    std::vector<Index>& number) {
  std::vector<std::vector<Index>> beside(P.columns);
  all.for_each_reached(A, P, [&](Index I, Index J) {
    if (I != J) beside[std::max(I, J)].push_back(std::min(I, J));
  });
  Dissection halves(place);
  for (Index I = 0; I < P.columns; ++I) {
    sort_once(beside[I]);
    for (const Index J : beside[I]) halves.couple(I, J);
  }
  SymmetricBlocks<K> coarse;
  coarse.parts = halves.numbered(number);
  std::vector<std::vector<Index>> lower(P.columns);
  for (Index I = 0; I < P.columns; ++I) {
    for (const Index J : beside[I])
      lower[std::max(number[I], number[J])].push_back(std::min(number[I], number[J]));
    std::vector<Index>().swap(beside[I]);
  }
  for (std::vector<Index>& columns : lower) {
    std::sort(columns.begin(), columns.end());
    coarse.col.insert(coarse.col.end(), columns.begin(), columns.end());
    coarse.row.push_back(to_block_index(coarse.col.size()));
  }
  coarse.value.assign(coarse.col.size() * K * K, 0);
  coarse.diagonal.assign(std::size_t(P.columns) * K * K, 0);
  coarse.inverse.assign(std::size_t(P.columns) * K * K, 0);
  return coarse;
}

/// coarse += P' (X + X') P: rows of X have strictly lower blocks of A and half of the diagonal one,
/// so each block belongs to one row. Threads share the rows of X P, some of them at a time, and
/// then the rows of the coarse matrix, which add them up in their order.
template <int B, int K>
class GalerkinProduct {
 public:
  /// X + X': these blocks of A
  void add(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P, const Touched<B>& of,
           SymmetricBlocks<K>& coarse) {
    const Index count = static_cast<Index>(of.rows.size());
    rows_.resize(std::max<std::size_t>(rows_.size(), std::min(count, at_a_time)));
    const Index shares = std::clamp(rows_of_vector * count / least_range, 1,
                                    std::min({P.columns, Threads::own(), most_shares}));
    for (Index begin = 0; begin < count; begin += at_a_time) {
      const Index n = std::min(at_a_time, count - begin);
      in_ranges(n, rows_of_vector * n, [&](Index first, Index end) {
        std::vector<Index> place(P.columns, -1);
        for (Index q = first; q < end; ++q) make_row(A, P, of, begin + q, place, rows_[q]);
      });
      side_by_side(shares, [&](Index k) {
        const Index first = share_begin(coarse, k, shares);
        const Index end = share_begin(coarse, k + 1, shares);
        for (Index q = 0; q < n; ++q) scatter(P, rows_[q], first, end, coarse);
      });
    }
  }

 private:
  static constexpr Index at_a_time = 1024;     ///< rows of X P: they stay in a cache
  static constexpr Index rows_of_vector = 16;  ///< that take as long as a row of a product
  static constexpr Index most_shares = 8;      ///< of the coarse rows: each looks at all of X P

  /// A row of X P
  struct Row {
    Index of;
    std::vector<Index> column;
    std::vector<float> product;  ///< B x K for each column
  };

  static bool are_zero(const float* begin, const float* end) {
    return std::all_of(begin, end, [](float a) { return a == 0; });
  }

  /// place: of each coarse column in the row; -1: absent, as all are before and after
  static void make_row(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P,
                       const Touched<B>& of, Index q, std::vector<Index>& place, Row& row) {
    const Index i = row.of = of.rows[q];
    row.column.clear();
    row.product.clear();
    if (are_zero(P.at(P.row[i]), P.at(P.row[i + 1]))) return;      // a node that sticks
    const auto add = [&](float factor, const float* a, Index j) {  // the row += factor a P_j
      if (are_zero(a, a + B * B)) return;
      for (Index c = P.row[j]; c < P.row[j + 1]; ++c) {
        Index& at = place[P.col[c]];
        if (at < 0) {
          at = static_cast<Index>(row.column.size());
          row.column.push_back(P.col[c]);
          row.product.resize(row.product.size() + B * K, 0);
        }
        add_block_product<B, B, K>(factor, a, P.at(c),
                                   row.product.data() + std::size_t(at) * B * K);
      }
    };
    add(0.5f, A.diagonal_at(i), i);
    for (Index k = of.begin[q]; k < of.begin[q + 1]; ++k)
      add(1, A.at(of.lower[k]), A.col[of.lower[k]]);
    for (const Index J : row.column) place[J] = -1;
  }
  /// The row of A at which share k of its blocks begins
  static Index share_begin(const SymmetricBlocks<K>& A, Index k, Index shares) {
    if (k == shares) return A.rows();
    const Index block = range_begin(A.row.back(), k, shares);
    return static_cast<Index>(std::lower_bound(A.row.begin(), A.row.end(), block) - A.row.begin());
  }

  /// Rows first .. end-1 of coarse += P_i' T + T' P_i, T row i of X P
  static void scatter(const Prolongation<B, K>& P, const Row& row, Index first, Index end,
                      SymmetricBlocks<K>& coarse) {
    for (Index q = P.row[row.of]; q < P.row[row.of + 1]; ++q) {
      const Index I = P.col[q];
      if (I >= end) continue;
      const float* p = P.at(q);
      for (std::size_t c = 0; c < row.column.size(); ++c) {
        const Index J = row.column[c], of = std::max(I, J);
        if (of < first || of >= end) continue;
        const float* t = row.product.data() + c * B * K;
        if (I > J) {
          add_transposed_block_product<K, B, K>(p, t, coarse.at(coarse.find(I, J)));
        } else if (I < J) {
          add_transposed_block_product<K, B, K>(t, p, coarse.at(coarse.find(J, I)));
        } else {
          add_transposed_block_product<K, B, K>(p, t, coarse.diagonal_at(I));
          add_transposed_block_product<K, B, K>(t, p, coarse.diagonal_at(I));
        }
      }
    }
  }

  std::vector<Row> rows_;
};

}  // namespace frictioncg
