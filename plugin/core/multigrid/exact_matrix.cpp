#include "multigrid/exact_matrix.h"

namespace frictioncg {

namespace {

/// What one half of A may make of a product beside A itself, in the norms of diag(A).
constexpr Real asymmetry = 1e-13;

/// D reals, the first two in one register.
template <int D>
struct Reals {
  Pair pair;
  Real third;

  static Reals load(const Real* p) { return {frictioncg::load<Pair>(p), D == 3 ? p[2] : 0}; }
  void store(Real* p) const {
    frictioncg::store(p, pair);
    if (D == 3) p[2] = third;
  }
  Real sum() const { return pair[0] + pair[1] + third; }
  void add(const Reals& a, const Reals& b) {
    pair += a.pair * b.pair;
    if (D == 3) third += a.third * b.third;
  }
  void add(const Reals& a, Real factor) {
    pair += a.pair * factor;
    if (D == 3) third += a.third * factor;
  }
};

}  // namespace

/// y_ = A x_
template <int D>
void ExactMatrix<D>::multiply_slots(const SymmetricBlocks<D>& places) {
  for (std::size_t i = 0; i < std::size_t(places.rows()); ++i) {
    const Real* x_i = x_.data() + i * D;
    Reals<D> sum[D] = {};
    for (int r = 0; r < D; ++r)
      sum[r].add(Reals<D>::load(diagonal.data() + (i * D + r) * D), Reals<D>::load(x_i));
    for (Index k = places.row[i]; k < places.row[i + 1]; ++k) {
      const Real* a = lower.data() + std::size_t(k) * D * D;
      const std::size_t j = std::size_t(places.col[k]) * D;
      const Reals<D> x_j = Reals<D>::load(x_.data() + j);
      Reals<D> y_j = Reals<D>::load(y_.data() + j);
      for (int r = 0; r < D; ++r) {
        const Reals<D> row = Reals<D>::load(row_of<D>(a, r));
        sum[r].add(row, x_j);
        y_j.add(row, x_i[r]);
      }
      y_j.store(y_.data() + j);
    }
    for (int r = 0; r < D; ++r) y_[Eigen::Index(i) * D + r] = sum[r].sum();
  }
}

template <int D>
bool ExactMatrix<D>::multiply(const SymmetricBlocks<D>& places, const std::vector<Index>& slot,
                              const Vector& x, Vector& Ax) {
  const Index n = static_cast<Index>(slot.size());
  if (diagonal.empty()) return false;
  if (x_.size() == 0) x_ = y_ = Vector::Zero(Eigen::Index(places.rows()) * D);
  for (Index p = 0; p < n; ++p) x_[slot[p]] = x[p];
  multiply_slots(places);
  Ax.resize(n);
  for (Index p = 0; p < n; ++p) Ax[p] = y_[slot[p]];
  return true;
}

template <int D>
void ExactMatrix<D>::keep_if_symmetric(const Matrix& A, const SymmetricBlocks<D>& places,
                                       const std::vector<Index>& slot) {
  const Vector root = A.diagonal().cwiseSqrt();
  const Vector w = Vector::LinSpaced(A.rows(), 1, Real(A.rows())).array().cos();
  const Vector x = w.cwiseQuotient(root);
  Vector Ax;
  multiply(places, slot, x, Ax);
  Ax -= A * x;
  if (!(Ax.cwiseQuotient(root).norm() <= asymmetry * w.norm())) *this = {};
}

template class ExactMatrix<2>;
template class ExactMatrix<3>;

}  // namespace frictioncg
