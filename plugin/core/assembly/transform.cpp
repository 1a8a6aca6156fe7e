#include "assembly/transform.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace frictioncg {

namespace {

constexpr Real asymmetry = 1e-9;  ///< |a_ij - a_ji| over sqrt(a_ii a_jj) that is refused

using Entry = Eigen::Triplet<Real, Index>;

/// The entries of A_local, each as (row, column, value), in no order: what setFromTriplets reads.
/// First the triplets between dofs with factor 1, then what sort_out has made of the others.
class LocalEntries {
 public:
  LocalEntries(const Triplets& A, const Images& images, const std::vector<Entry>& others)
      : A_(A), image_(images.plain.data()), others_(others) {}

  class Iterator {
   public:
    Iterator(const LocalEntries& all, std::size_t k) : all_(all), k_(k) { settle(); }
    Index row() const { return row_; }
    Index col() const { return col_; }
    Real value() const { return value_; }
    const Iterator* operator->() const { return this; }
    bool operator!=(const Iterator& o) const { return k_ != o.k_ || mirror_ != o.mirror_; }
    Iterator& operator++() {
      if (all_.A_.half && !mirror_ && k_ < all_.A_.size && row_ != col_) {
        mirror_ = true;
        std::swap(row_, col_);
      } else {
        mirror_ = false;
        ++k_;
        settle();
      }
      return *this;
    }

   private:
    /// The first entry from k on that lies in A_local.
    void settle() {
      const Triplets& A = all_.A_;
      for (; k_ < A.size; ++k_) {
        row_ = all_.image_[A.row(k_)];
        col_ = all_.image_[A.col(k_)];
        value_ = A.a[k_];
        if (row_ >= 0 && col_ >= 0 && value_ != 0) return;
      }
      if (k_ == A.size + all_.others_.size()) return;
      const Entry& e = all_.others_[k_ - A.size];
      row_ = e.row();
      col_ = e.col();
      value_ = e.value();
    }
    const LocalEntries& all_;
    std::size_t k_;
    bool mirror_ = false;
    Index row_ = 0, col_ = 0;
    Real value_ = 0;
  };

  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, A_.size + others_.size()}; }

 private:
  const Triplets& A_;
  const Index* const image_;
  const std::vector<Entry>& others_;
};

/// The triplets that touch a dof that is held or whose factor is not 1, in the local dofs: those of
/// A_local, those of K.
struct Others {
  std::vector<Entry> local, couplings;

  Others(const Triplets& A, const Basis& basis, const Images& images) : w_(basis.local_dofs()) {
    std::vector<Entry> B;  // what touches a row of T with several entries
    const Index* plain = images.plain.data();
    for (std::size_t k = 0; k < A.size; ++k) {
      const Index i = A.row(k), j = A.col(k);
      if ((plain[i] >= 0 && plain[j] >= 0) || A.a[k] == 0) continue;
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
    if (!B.empty()) add_product(A.n, B, basis);
  }

 private:
  void sort(Index p, Index q, Real a) {
    if (q < w_)
      local.emplace_back(p, q, a);
    else
      couplings.emplace_back(p, q - w_, a);
  }
  /// T'BT
  void add_product(Index n, const std::vector<Entry>& B, const Basis& basis) {
    Matrix touching(n, n);
    touching.setFromTriplets(B.begin(), B.end());
    const Matrix right = touching * basis.T;
    const Matrix product = Matrix(basis.T.transpose()) * right;
    for (Index p = 0; p < w_; ++p)
      for (Matrix::InnerIterator e(product, p); e; ++e)
        sort(p, static_cast<Index>(e.col()), e.value());
  }
  const Index w_;
};

void check_size(const Triplets& A, const std::vector<Entry>& products) {
  const std::size_t most = (A.half ? 2 : 1) * A.size + products.size();
  if (most > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    throw IllegalInput("A has more than 2^31 - 1 entries; this build indexes them by 32 bits");
}

}  // namespace

void transform(const Triplets& A, const Basis& basis, Matrix& A_local, Matrix& K) {
  const Index w = basis.local_dofs();
  if (w == 0) throw IllegalInput("Dirichlet conditions hold every degree of freedom of A");
  const Images images(basis);
  const Others others(A, basis, images);
  check_size(A, others.local);
  K.resize(w, basis.T.cols() - w);
  K.setFromTriplets(others.couplings.begin(), others.couplings.end());
  const LocalEntries entries(A, images, others.local);
  A_local.resize(w, w);
  A_local.setFromTriplets(entries.begin(), entries.end());
}

/// A cursor a row meets the mirror image of each lower entry in order.
void check_symmetry(const Matrix& A_local, const Vector& D, const std::vector<Index>& origin) {
  const Index* row = A_local.outerIndexPtr();
  const Index* col = A_local.innerIndexPtr();
  const Real* a = A_local.valuePtr();
  std::vector<Index> cursor(A_local.rows());
  const auto compare = [&](Index p, Index q, Real a_pq, Real a_qp) {
    if (std::abs(a_pq - a_qp) <= asymmetry * std::sqrt(std::abs(D[p] * D[q]))) return;
    std::ostringstream m;
    m << "A(" << origin[p] << "," << origin[q] << ") = " << a_pq << " but A(" << origin[q] << ","
      << origin[p] << ") = " << a_qp
      << "; A must be symmetric (friction enters by mu, not by the matrix; blocks assembled with "
         "sym=1 lose a half in [[A1, 0], [0, A2]]: assemble them without)";
    throw IllegalInput(m.str());
  };
  for (Index p = 0; p < A_local.rows(); ++p) {
    for (Index k = row[p]; k < row[p + 1] && col[k] < p; ++k) {
      const Index q = col[k];
      Index& c = cursor[q];
      for (; c < row[q + 1] && col[c] < p; ++c) compare(q, col[c], a[c], 0);
      const bool mirrored = c < row[q + 1] && col[c] == p;
      compare(p, q, a[k], mirrored ? a[c] : 0);
      if (mirrored) ++c;
    }
    cursor[p] = static_cast<Index>(std::upper_bound(col + row[p], col + row[p + 1], p) - col);
  }
  for (Index q = 0; q < A_local.rows(); ++q)
    for (Index c = cursor[q]; c < row[q + 1]; ++c) compare(q, col[c], a[c], 0);
}

}  // namespace frictioncg
