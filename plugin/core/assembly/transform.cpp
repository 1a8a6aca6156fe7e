#include "assembly/basis.h"

#include "threads.h"

namespace frictioncg {

namespace {

/// A is refused where |a_ij - a_ji| is more than this share of sqrt(a_ii a_jj).
constexpr Real asymmetry = 1e-9;

/// A row of T with one entry: u_i = factor w[dof], beyond the local dofs where Dirichlet conditions
/// hold u_i.
struct Image {
  Index dof = -1;  ///< -1: the row has several entries
  Real factor = 1;
};

/// The entries of A_local by numbers, some of none: the triplets between dofs with factor 1, of
/// half-stored ones their mirror images, then what touches a dof that is held or whose factor is
/// not 1, in the local dofs. The same of K.
class Entries {
 public:
  Entries(const Triplets& A, const Basis& basis, Matrix& K)
      : A_(A), plain_(basis.T.rows(), -1), w_(basis.local_dofs()) {
    if (w_ == 0) throw IllegalInput("Dirichlet conditions hold every degree of freedom of A");
    const std::vector<Image> images = find_images(basis.T);
    EntryList couplings, B;  // B: what touches a row of T with several entries
    for (std::size_t k = 0; k < A.size; ++k) {
      const Index i = A.row(k), j = A.col(k);
      if (A.a[k] == 0 || (plain_[i] >= 0 && plain_[j] >= 0)) continue;
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
    if ((A.half ? 2 : 1) * A.size + others_.size() >
        static_cast<std::size_t>(std::numeric_limits<Index>::max()))
      throw IllegalInput("A has more than 2^31 - 1 entries; this build indexes them by 32 bits");
    K = sparse(w_, static_cast<Index>(basis.T.cols()) - w_, couplings);
  }

  /// visit(number, row, column, value) in the order of the numbers.   zeros: of A, too
  template <class Visit>
  void for_each(bool zeros, const Visit& visit) const {
    const Index size = static_cast<Index>(A_.size);
    for (Index k = 0; k < size; ++k) {
      const Index p = plain_[A_.row(k)], q = plain_[A_.col(k)];
      if (p < 0 || q < 0 || (A_.a[k] == 0 && !zeros)) continue;
      visit(k, p, q, A_.a[k]);
      if (A_.half && p != q) visit(size + k, q, p, A_.a[k]);
    }
    Index number = first_other();
    for (const auto& e : others_) visit(number++, e.row(), e.col(), e.value());
  }
  Index numbers() const { return first_other() + static_cast<Index>(others_.size()); }

 private:
  std::vector<Image> find_images(const Matrix& T) {
    std::vector<Image> images(T.rows());
    const auto [row, col, a] = arrays_of(T);
    for (Index i = 0; i < T.rows(); ++i) {
      if (row[i + 1] != row[i] + 1) continue;
      images[i] = {col[row[i]], a[row[i]]};
      if (images[i].factor == 1 && images[i].dof < w_) plain_[i] = images[i].dof;
    }
    return images;
  }
  void sort(Index p, Index q, Real a, EntryList& couplings) {
    if (q < w_)
      others_.emplace_back(p, q, a);
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
  Index first_other() const { return static_cast<Index>((A_.half ? 2 : 1) * A_.size); }

  const Triplets& A_;
  std::vector<Index> plain_;  ///< the local dof that a dof is, as nearly all are; else -1
  EntryList others_;
  const Index w_;
};

/// M, which is empty, of entries in any order; those of one place add. By setFromTriplets the
/// transformation would take twice as long, and more memory. Threads share rows.
void fill(Matrix& M, const Entries& entries, bool zeros) {
  std::vector<Index> lengths(M.rows(), 0);
  entries.for_each(zeros, [&](Index, Index p, Index, Real) { ++lengths[p]; });
  M.reserve(lengths);
  const Index* const row = M.outerIndexPtr();
  Index *const col = M.innerIndexPtr(), *const length = M.innerNonZeroPtr();
  Real* const a = M.valuePtr();
  entries.for_each(zeros, [&](Index, Index p, Index q, Real value) {
    const Index at = row[p] + length[p]++;
    col[at] = q;
    a[at] = value;
  });
  const auto sort_rows = [&](Index first, Index last) {
    std::vector<std::pair<Index, Index>> sorted;  // columns, and where their entries were
    std::vector<Real> values;
    for (Index p = first; p < last; ++p) {
      values.assign(a + row[p], a + row[p + 1]);
      sorted.clear();
      for (Index k = row[p]; k < row[p + 1]; ++k) sorted.emplace_back(col[k], k - row[p]);
      std::sort(sorted.begin(), sorted.end());
      Index at = row[p];
      for (const auto& [q, k] : sorted) {
        if (at == row[p] || col[at - 1] != q) col[at] = q, a[at++] = 0;
        a[at - 1] += values[k];
      }
      length[p] = at - row[p];
    }
  };
  const Index n = static_cast<Index>(M.rows());
  with_threads(n, [&] { in_ranges(n, sort_rows); });
  M.makeCompressed();
}

/// The values of M anew. False where an entry lies outside its pattern. Places that do not hold are
/// found.
bool refill(Matrix& M, Places& places, const Entries& entries) {
  places.resize(entries.numbers(), -1);
  const Index* row = M.outerIndexPtr();
  const Index* col = M.innerIndexPtr();
  std::fill_n(M.valuePtr(), M.nonZeros(), 0.0);
  bool inside = true;
  entries.for_each(false, [&](Index number, Index p, Index q, Real value) {
    Index& at = places[number];
    const bool there = at >= row[p] && at < row[p + 1] && col[at] == q;
    if (!there) at = static_cast<Index>(std::lower_bound(col + row[p], col + row[p + 1], q) - col);
    if (at < row[p + 1] && col[at] == q)
      M.valuePtr()[at] += value;
    else
      inside = false;
  });
  return inside;
}

}  // namespace

void transform(const Triplets& A, const Basis& basis, Places& places, Matrix& A_local, Matrix& K) {
  const Entries entries(A, basis, K);
  const Index w = basis.local_dofs();
  if (A_local.rows() == w && refill(A_local, places, entries)) return;
  const bool again = A_local.rows() > 0;
  A_local.resize(w, w);
  fill(A_local, entries, again);
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
