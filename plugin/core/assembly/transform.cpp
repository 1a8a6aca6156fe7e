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
class LocalEntries {
 public:
  LocalEntries(const Triplets& A, const std::vector<Image>& image, Index local_dofs,
               const std::vector<Entry>& products)
      : A_(A), image_(image), local_dofs_(local_dofs), products_(products) {}

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
        if (A.a[k_] == 0) continue;
        const Image &P = all_.image_[A.row(k_)], &Q = all_.image_[A.col(k_)];
        if (!P.single() || !Q.single() || P.image >= all_.local_dofs_ ||
            Q.image >= all_.local_dofs_)
          continue;
        row_ = P.image;
        col_ = Q.image;
        value_ = P.factor * Q.factor * A.a[k_];
        return;
      }
      if (k_ == A.size + all_.products_.size()) return;
      const Entry& e = all_.products_[k_ - A.size];
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
  Iterator end() const { return {*this, A_.size + products_.size()}; }

 private:
  const Triplets& A_;
  const std::vector<Image>& image_;
  const Index local_dofs_;
  const std::vector<Entry>& products_;
};

/// T'BT, B the entries of A that touch a row of T with several entries.
Matrix product_part(const Triplets& A, const Basis& basis, const std::vector<Image>& image) {
  std::vector<Entry> B;
  for (std::size_t k = 0; k < A.size; ++k) {
    const Index i = A.row(k), j = A.col(k);
    if (A.a[k] == 0 || (image[i].single() && image[j].single())) continue;
    B.emplace_back(i, j, A.a[k]);
    if (A.half && i != j) B.emplace_back(j, i, A.a[k]);
  }
  Matrix touching(A.n, A.n);
  touching.setFromTriplets(B.begin(), B.end());
  const Matrix right = touching * basis.T;
  return Matrix(basis.T.transpose()) * right;
}

/// Entries (free, held) among those whose rows of T are single.
std::vector<Entry> single_couplings(const Triplets& A, const std::vector<Image>& image,
                                    Index local_dofs) {
  std::vector<Entry> K;
  const auto couple = [&](const Image& free, const Image& held, Real a) {
    if (free.image < local_dofs && held.image >= local_dofs)
      K.emplace_back(free.image, held.image - local_dofs, free.factor * a);
  };
  for (std::size_t k = 0; k < A.size; ++k) {
    if (A.a[k] == 0) continue;
    const Image &P = image[A.row(k)], &Q = image[A.col(k)];
    if (!P.single() || !Q.single()) continue;
    couple(P, Q, A.a[k]);
    if (A.half) couple(Q, P, A.a[k]);
  }
  return K;
}

void check_size(const Triplets& A, const std::vector<Entry>& products) {
  const std::size_t most = (A.half ? 2 : 1) * A.size + products.size();
  if (most > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    throw IllegalInput("A has more than 2^31 - 1 entries; this build indexes them by 32 bits");
}

}  // namespace

void transform(const Triplets& A, const Basis& basis, Matrix& A_local, Matrix& K) {
  const Index w = basis.local_dofs();
  if (w == 0) throw IllegalInput("Dirichlet conditions hold every degree of freedom of A");
  const std::vector<Image> image = images(basis);
  std::vector<Entry> products, couplings = single_couplings(A, image, w);
  if (!std::all_of(image.begin(), image.end(), [](const Image& i) { return i.single(); })) {
    const Matrix part = product_part(A, basis, image);
    for (Index p = 0; p < w; ++p)
      for (Matrix::InnerIterator e(part, p); e; ++e)
        if (e.col() < w)
          products.emplace_back(p, static_cast<Index>(e.col()), e.value());
        else
          couplings.emplace_back(p, static_cast<Index>(e.col()) - w, e.value());
  }
  check_size(A, products);
  K.resize(w, basis.T.cols() - w);
  K.setFromTriplets(couplings.begin(), couplings.end());
  const LocalEntries entries(A, image, w, products);
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
      << "; A must be symmetric (friction enters by mu, not by the matrix)";
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
