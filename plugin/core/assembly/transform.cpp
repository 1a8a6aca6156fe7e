#include "assembly/transform.h"

namespace frictioncg {

namespace {

/// A is refused where |a_ij - a_ji| is more than this share of sqrt(a_ii a_jj).
constexpr Real asymmetry = 1e-9;

/// Entries are fetched from memory so many before their turn.
constexpr Index ahead = 24;

/// What one pass over the triplets tells: those that touch a dof that is held or whose factor is
/// not 1, in the local dofs, those of A_local and those of K; and how many entries lie in each row
/// and column of A_local, at [1 ..].
struct Others {
  EntryList local, couplings;
  std::vector<Index> rows, columns;

  Others(const Triplets& A, const Basis& basis, const Images& images)
      : rows(basis.local_dofs() + 1, 0), columns(rows), w_(basis.local_dofs()) {
    EntryList B;  // what touches a row of T with several entries
    const Index* plain = images.plain.data();
    for (std::size_t k = 0; k < A.size; ++k) {
      const Index i = A.row(k), j = A.col(k);
      if (A.a[k] == 0) continue;
      if (plain[i] >= 0 && plain[j] >= 0) {
        count(plain[i], plain[j]);
        if (A.half && i != j) count(plain[j], plain[i]);
        continue;
      }
      const Images::Image &P = images.all[i], &Q = images.all[j];
      const bool single = P.single() && Q.single();
      const auto add = [&](Index row, Index column, const Images::Image& left,
                           const Images::Image& right) {
        if (!single)
          B.emplace_back(row, column, A.a[k]);
        else if (left.image < w_)
          sort(left.image, right.image, left.factor * right.factor * A.a[k]);
      };
      add(i, j, P, Q);
      if (A.half && i != j) add(j, i, Q, P);
    }
    if (!B.empty()) add_product(B, basis);
    for (const auto& e : local) count(e.row(), e.col());
  }

 private:
  void count(Index p, Index q) {
    ++rows[p + 1];
    ++columns[q + 1];
  }
  void sort(Index p, Index q, Real a) {
    if (q < w_)
      local.emplace_back(p, q, a);
    else
      couplings.emplace_back(p, q - w_, a);
  }
  /// T'BT
  void add_product(const EntryList& B, const Basis& basis) {
    const Matrix right = sparse(basis.T.rows(), basis.T.rows(), B) * basis.T;
    const Matrix product = Matrix(basis.T.transpose()) * right;
    for (Index p = 0; p < w_; ++p)
      for (Matrix::InnerIterator e(product, p); e; ++e)
        sort(p, static_cast<Index>(e.col()), e.value());
  }
  const Index w_;
};

void check_size(const Triplets& A, const EntryList& products) {
  const std::size_t most = (A.half ? 2 : 1) * A.size + products.size();
  if (most > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    throw IllegalInput("A has more than 2^31 - 1 entries; this build indexes them by 32 bits");
}

/// The entries of A_local by numbers, some of none: the triplets between dofs with factor 1, of
/// half-stored ones their mirror images, then what Others has made of the others.
class Entries {
 public:
  /// zeros: those of A are entries, too
  Entries(const Triplets& A, const Images& images, const EntryList& others, bool zeros = false)
      : A_(A), plain_(images.plain.data()), others_(others), zeros_(zeros) {}

  /// visit(number, row, column) in the order of the numbers
  template <class Visit>
  void for_each(const Visit& visit) const {
    const Index size = static_cast<Index>(A_.size);
    for (Index k = 0; k < size; ++k) {
      const Index p = plain_[A_.row(k)], q = plain_[A_.col(k)];
      if (p < 0 || q < 0 || (A_.a[k] == 0 && !zeros_)) continue;
      visit(k, p, q);
      if (A_.half && p != q) visit(size + k, q, p);
    }
    for (Index k = 0; k < static_cast<Index>(others_.size()); ++k)
      visit(first_other() + k, others_[k].row(), others_[k].col());
  }
  Index numbers() const { return first_other() + static_cast<Index>(others_.size()); }
  Index row(Index number) const {
    const Index size = static_cast<Index>(A_.size);
    if (number < size) return plain_[A_.row(number)];
    if (number < first_other()) return plain_[A_.col(number - size)];
    return others_[number - first_other()].row();
  }
  /// Starts to read an entry that is soon asked for.
  void fetch(Index number) const {
    if (number >= static_cast<Index>(A_.size)) return;
    __builtin_prefetch(A_.i + number);
    __builtin_prefetch(A_.a + number);
  }
  Real value(Index number) const {
    const Index size = static_cast<Index>(A_.size);
    if (number >= first_other()) return others_[number - first_other()].value();
    return A_.a[number < size ? number : number - size];
  }

 private:
  Index first_other() const { return static_cast<Index>((A_.half ? 2 : 1) * A_.size); }

  const Triplets& A_;
  const Index* plain_;
  const EntryList& others_;
  const bool zeros_;
};

/// Where each bucket starts, and where the last one ends, from their sizes in start[1..].
void add_up(std::vector<Index>& start) {
  std::partial_sum(start.begin(), start.end(), start.begin());
}

/// Rows of M lie from row[p] to end[p]: moves them together.
void close_up(const std::vector<Index>& row, const std::vector<Index>& end, Matrix& M) {
  Index* col = M.innerIndexPtr();
  Real* a = M.valuePtr();
  Index size = 0;
  for (Index p = 0; p < M.rows(); ++p) {
    M.outerIndexPtr()[p] = size;
    const Index length = end[p] - row[p];
    if (size < row[p]) {
      std::copy_n(col + row[p], length, col + size);
      std::copy_n(a + row[p], length, a + size);
    }
    size += length;
  }
  M.outerIndexPtr()[M.rows()] = size;
  M.resizeNonZeros(size);
}

/// M (n x n) of entries in any order; those of one place add. Sorted into buckets twice, by columns
/// and from these by rows: their numbers alone, which takes the least memory. row, column: how many
/// lie in each, at [1 ..]. By setFromTriplets the transformation would take half as much again.
void fill(Matrix& M, const Entries& entries, std::vector<Index> row, std::vector<Index> column) {
  const Index n = static_cast<Index>(row.size()) - 1;
  add_up(row);
  add_up(column);
  const std::unique_ptr<Index[]> number(new Index[row[n]]);
  std::vector<Index> end(column.begin(), column.end() - 1);
  entries.for_each([&](Index k, Index, Index q) { number[end[q]++] = k; });
  M.resize(n, n);
  M.resizeNonZeros(row[n]);
  std::copy(row.begin(), row.end() - 1, end.begin());
  Index* col = M.innerIndexPtr();
  Real* a = M.valuePtr();
  for (Index q = 0; q < n; ++q)
    for (Index k = column[q]; k < column[q + 1]; ++k) {
      entries.fetch(number[std::min(k + ahead, row[n] - 1)]);
      const Index p = entries.row(number[k]);
      Index& at = end[p];
      if (at > row[p] && col[at - 1] == q) {
        a[at - 1] += entries.value(number[k]);
      } else {
        col[at] = q;
        a[at++] = entries.value(number[k]);
      }
    }
  close_up(row, end, M);
}

/// The same, with the zeros that A stores.
void fill_with_zeros(Matrix& M, Index n, const Entries& entries) {
  std::vector<Index> row(n + 1, 0), column(row);
  entries.for_each([&](Index, Index p, Index q) {
    ++row[p + 1];
    ++column[q + 1];
  });
  fill(M, entries, row, column);
}

/// The values of M anew. False where an entry lies outside its pattern. Places that do not hold are
/// found.
bool refill(Matrix& M, Places& places, const Entries& entries) {
  places.resize(entries.numbers(), -1);
  const Index* row = M.outerIndexPtr();
  const Index* col = M.innerIndexPtr();
  std::fill_n(M.valuePtr(), M.nonZeros(), 0.0);
  bool inside = true;
  entries.for_each([&](Index number, Index p, Index q) {
    Index& at = places[number];
    const bool there = at >= row[p] && at < row[p + 1] && col[at] == q;
    if (!there) at = static_cast<Index>(std::lower_bound(col + row[p], col + row[p + 1], q) - col);
    if (at < row[p + 1] && col[at] == q)
      M.valuePtr()[at] += entries.value(number);
    else
      inside = false;
  });
  return inside;
}

/// What both forms of the transformation share: make(images, others) makes A_local, n_w x n_w.
template <class Make>
void transform(const Triplets& A, const Basis& basis, Matrix& K, const Make& make) {
  const Index w = basis.local_dofs();
  if (w == 0) throw IllegalInput("Dirichlet conditions hold every degree of freedom of A");
  const Images images(basis);
  const Others others(A, basis, images);
  check_size(A, others.local);
  K = sparse(w, static_cast<Index>(basis.T.cols()) - w, others.couplings);
  make(images, others);
}

}  // namespace

void transform(const Triplets& A, const Basis& basis, Matrix& A_local, Matrix& K) {
  transform(A, basis, K, [&](const Images& images, const Others& others) {
    fill(A_local, Entries(A, images, others.local), others.rows, others.columns);
  });
}

void transform_again(const Triplets& A, const Basis& basis, Places& places, Matrix& A_local,
                     Matrix& K) {
  const Index w = basis.local_dofs();
  transform(A, basis, K, [&](const Images& images, const Others& others) {
    if (A_local.rows() == w && refill(A_local, places, Entries(A, images, others.local))) return;
    fill_with_zeros(A_local, w, Entries(A, images, others.local, true));
    places.clear();
  });
}

/// A cursor a row meets the mirror image of each lower entry in order.
void check_symmetry(const Triplets& A, const Matrix& A_local, const Vector& D,
                    const std::vector<Index>& origin) {
  const auto [row, col, a] = arrays_of(A_local);
  std::vector<Index> cursor(A_local.rows());
  const auto has_row = [&](Index i) { return i < A.n && A.is_whole(i); };
  const auto compare = [&](Index p, Index q, Real a_pq, Real a_qp) {
    if (a_pq == a_qp || !has_row(origin[p]) || !has_row(origin[q])) return;
    if (std::abs(a_pq - a_qp) <= asymmetry * std::sqrt(std::abs(D[p] * D[q]))) return;
    refuse("A(", origin[p], ",", origin[q], ") = ", a_pq, " but A(", origin[q], ",", origin[p],
           ") = ", a_qp,
           "; A must be symmetric (friction enters by mu, not by the matrix; blocks assembled with "
           "sym=1 lose a half in [[A1, 0], [0, A2]]: assemble them without)");
  };
  for (Index p = 0; p < A_local.rows(); ++p) {
    Index k = row[p];
    for (; k < row[p + 1] && col[k] < p; ++k) {
      const Index q = col[k];
      Index& c = cursor[q];
      for (; c < row[q + 1] && col[c] < p; ++c) compare(q, col[c], a[c], 0);
      const bool mirrored = c < row[q + 1] && col[c] == p;
      compare(p, q, a[k], mirrored ? a[c] : 0);
      if (mirrored) ++c;
    }
    cursor[p] = k < row[p + 1] && col[k] == p ? k + 1 : k;
  }
  for (Index q = 0; q < A_local.rows(); ++q)
    for (Index c = cursor[q]; c < row[q + 1]; ++c) compare(q, col[c], a[c], 0);
}

}  // namespace frictioncg
