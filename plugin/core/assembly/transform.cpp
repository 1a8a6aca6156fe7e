#include "assembly/basis.h"

#include "threads.h"

namespace frictioncg {

namespace {

/// A is refused where |a_ij - a_ji| is more than this share of sqrt(a_ii a_jj).
constexpr Real asymmetry = 1e-9;

/// Entries are fetched from memory so many before their turn.
constexpr Index ahead = 24;

/// A row of T with one entry: u_i = factor w[dof], beyond the local dofs where Dirichlet conditions
/// hold u_i.
struct Image {
  Index dof = -1;  ///< -1: the row has several entries
  Real factor = 1;
};

/// Rows 0 .. n-1 in ranges of one length, one for each thread of the call, which reads all entries:
/// more than a few gain nothing.
struct Shares {
  static constexpr Index most = 4;
  explicit Shares(Index n)
      : count(std::clamp(n / least_range, 1, std::min(most, Threads::own()))),
        of_a_row((std::uint64_t(count) << 32) / std::max(1, n)) {}
  Index of(Index p) const { return static_cast<Index>(of_a_row * std::uint64_t(p) >> 32); }

  const Index count;
  const std::uint64_t of_a_row;  ///< over 2^32
};

/// How many entries lie in each row, and in each column of the rows of a share, at [1 ..].
struct Counts {
  explicit Counts(Index n)
      : shares(n), rows(n + 1, 0), columns(std::size_t(n) * shares.count + 1, 0) {}
  void add(Index p, Index q) {
    ++rows[p + 1];
    ++columns[(shares.count == 1 ? 0 : first(shares.of(p))) + q + 1];
  }
  std::size_t first(Index share) const { return share * (rows.size() - 1); }

  const Shares shares;
  std::vector<Index> rows, columns;
};

/// What one pass over the triplets tells: those that touch a dof that is held or whose factor is
/// not 1, in the local dofs, those of A_local and those of K; and where entries of A_local lie.
struct Split {
  std::vector<Index> plain;  ///< the local dof that a dof is, as nearly all are; negative otherwise
  EntryList local;
  Counts counts;

  Split(const Triplets& A, const Basis& basis, Matrix& K)
      : plain(basis.T.rows(), -1), counts(basis.local_dofs()), w_(basis.local_dofs()) {
    if (w_ == 0) throw IllegalInput("Dirichlet conditions hold every degree of freedom of A");
    const std::vector<Image> images = find_images(basis.T);
    EntryList couplings, B;  // B: what touches a row of T with several entries
    for (std::size_t k = 0; k < A.size; ++k) {
      const Index i = A.row(k), j = A.col(k);
      if (A.a[k] == 0) continue;
      if (plain[i] >= 0 && plain[j] >= 0) {
        counts.add(plain[i], plain[j]);
        if (A.half && i != j) counts.add(plain[j], plain[i]);
        continue;
      }
      const Image &P = images[i], &Q = images[j];
      const bool single = P.dof >= 0 && Q.dof >= 0;
      const auto add = [&](Index row, Index column, const Image& left, const Image& right) {
        if (!single)
          B.emplace_back(row, column, A.a[k]);
        else if (left.dof < w_)
          sort(left.dof, right.dof, left.factor * right.factor * A.a[k], couplings);
      };
      add(i, j, P, Q);
      if (A.half && i != j) add(j, i, Q, P);
    }
    if (!B.empty()) add_product(B, basis.T, couplings);
    for (const auto& e : local) counts.add(e.row(), e.col());
    if ((A.half ? 2 : 1) * A.size + local.size() >
        static_cast<std::size_t>(std::numeric_limits<Index>::max()))
      throw IllegalInput("A has more than 2^31 - 1 entries; this build indexes them by 32 bits");
    K = sparse(w_, static_cast<Index>(basis.T.cols()) - w_, couplings);
  }

 private:
  std::vector<Image> find_images(const Matrix& T) {
    std::vector<Image> images(T.rows());
    const auto [row, col, a] = arrays_of(T);
    for (Index i = 0; i < T.rows(); ++i) {
      if (row[i + 1] != row[i] + 1) continue;
      images[i] = {col[row[i]], a[row[i]]};
      if (images[i].factor == 1 && images[i].dof < w_) plain[i] = images[i].dof;
    }
    return images;
  }
  void sort(Index p, Index q, Real a, EntryList& couplings) {
    if (q < w_)
      local.emplace_back(p, q, a);
    else
      couplings.emplace_back(p, q - w_, a);
  }
  /// T'BT
  void add_product(const EntryList& B, const Matrix& T, EntryList& couplings) {
    const Matrix product = Matrix(T.transpose()) * Matrix(sparse(T.rows(), T.rows(), B) * T);
    for (Index p = 0; p < w_; ++p)
      for (Matrix::InnerIterator e(product, p); e; ++e)
        sort(p, static_cast<Index>(e.col()), e.value(), couplings);
  }
  const Index w_;
};

/// The entries of A_local by numbers, some of none: the triplets between dofs with factor 1, of
/// half-stored ones their mirror images, then what Split has made of the others.
class Entries {
 public:
  /// zeros: those of A are entries, too
  Entries(const Triplets& A, const Split& split, bool zeros = false)
      : A_(A), plain_(split.plain.data()), others_(split.local), zeros_(zeros) {}

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
/// and from these by rows: their numbers alone, which takes the least memory. By setFromTriplets
/// the transformation would take half as much again. Threads share rows.
void fill(Matrix& M, const Entries& entries, Counts counts) {
  std::vector<Index>&row = counts.rows, &column = counts.columns;
  const Index n = static_cast<Index>(row.size()) - 1;
  for (auto* start : {&row, &column})
    std::partial_sum(start->begin(), start->end(), start->begin());
  const std::unique_ptr<Index[]> number(new Index[row[n]]);
  std::vector<Index> next(column.begin(), column.end() - 1), end(row.begin(), row.end() - 1);
  M.resize(n, n);
  M.resizeNonZeros(row[n]);
  Index* col = M.innerIndexPtr();
  Real* a = M.valuePtr();
  const auto fill_share = [&](Index share) {
    const std::size_t first = counts.first(share);
    entries.for_each([&](Index k, Index p, Index q) {
      if (counts.shares.count == 1 || counts.shares.of(p) == share) number[next[first + q]++] = k;
    });
    const Index* of_column = column.data() + first;
    for (Index q = 0; q < n; ++q)
      for (Index k = of_column[q]; k < of_column[q + 1]; ++k) {
        entries.fetch(number[std::min(k + ahead, of_column[n] - 1)]);
        const Index p = entries.row(number[k]);
        Index& at = end[p];
        if (at > row[p] && col[at - 1] == q) {
          a[at - 1] += entries.value(number[k]);
        } else {
          col[at] = q;
          a[at++] = entries.value(number[k]);
        }
      }
  };
  with_threads(n, [&] { side_by_side(counts.shares.count, fill_share); });
  close_up(row, end, M);
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

}  // namespace

void transform(const Triplets& A, const Basis& basis, Places& places, Matrix& A_local, Matrix& K) {
  const Split split(A, basis, K);
  const Index w = basis.local_dofs();
  if (A_local.rows() == w && refill(A_local, places, Entries(A, split))) return;
  const bool again = A_local.rows() > 0;
  const Entries entries(A, split, again);
  Counts counts = again ? Counts(w) : split.counts;
  if (again) entries.for_each([&](Index, Index p, Index q) { counts.add(p, q); });
  fill(A_local, entries, std::move(counts));
  places.clear();
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
