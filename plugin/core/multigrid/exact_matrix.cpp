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

template <int D>
bool ExactMatrix<D>::multiply(const SymmetricBlocks<D>& places, const std::vector<Index>& slot,
                              const Vector& x, Vector& Ax) {
  const Index n = static_cast<Index>(slot.size());
  if (diagonal.empty()) return false;
  if (x_.size() == 0) x_ = y_ = Vector::Zero(Eigen::Index(places.rows()) * D);
  in_ranges(n, [&](Index first, Index end) {
    for (Index p = first; p < end; ++p) x_[slot[p]] = x[p];
  });
  places.parts.upwards([&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
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
  });
  Ax.resize(n);
  in_ranges(n, [&](Index first, Index end) {
    for (Index p = first; p < end; ++p) Ax[p] = y_[slot[p]];
  });
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

template <int D>
SymmetricBlocks<D> make_fine_matrix(const Matrix& A, const NodeBlocks& blocks, Real factor,
                                    ExactMatrix<D>& exact) {
  const Arrays of_A = arrays_of(A);
  SymmetricBlocks<D> M;
  M.parts = blocks.parts;
  M.diagonal.assign(std::size_t(blocks.blocks) * D * D, 0);
  M.inverse.assign(std::size_t(blocks.blocks) * D * D, 0);
  exact.diagonal.assign(std::size_t(blocks.blocks) * D * D, 0);
  M.row.reserve(blocks.blocks + 1);
  std::vector<Index> block_of(blocks.slot.size()), place(blocks.blocks, -1);
  for (std::size_t p = 0; p < block_of.size(); ++p) block_of[p] = blocks.slot[p] / D;
  // visit(place in the block, entry) for the dofs of block i
  const auto for_each_entry = [&](Index i, auto visit) {
    for (Index r = 0; r < D; ++r) {
      const Index p = blocks.dof[i * D + r];
      if (p < 0) continue;
      for (Index e = of_A.row[p]; e < of_A.row[p + 1]; ++e) visit(r, e);
    }
  };
  for (Index i = 0; i < blocks.blocks; ++i) {
    const std::size_t first = M.col.size();
    for_each_entry(i, [&](Index, Index e) {
      const Index j = block_of[of_A.col[e]];
      if (j >= i || place[j] >= Index(first)) return;
      place[j] = static_cast<Index>(M.col.size());
      M.col.push_back(j);
    });
    std::sort(M.col.begin() + std::ptrdiff_t(first), M.col.end());
    M.row.push_back(to_block_index(M.col.size()));
  }
  exact.lower.assign(M.col.size() * D * D, 0);
  for (Index i = 0; i < blocks.blocks; ++i) {
    for (Index k = M.row[i]; k < M.row[i + 1]; ++k) place[M.col[k]] = k;
    for_each_entry(i, [&](Index r, Index e) {
      const Index j = block_of[of_A.col[e]], c = blocks.slot[of_A.col[e]] - j * D;
      if (j < i)
        exact.lower[(std::size_t(place[j]) * D + r) * D + c] = of_A.a[e];
      else if (j == i)
        exact.diagonal[(std::size_t(i) * D + r) * D + c] = of_A.a[e];
    });
  }
  const auto scaled = [factor](Real entry) { return static_cast<float>(factor * entry); };
  M.value.resize(exact.lower.size());
  std::transform(exact.lower.begin(), exact.lower.end(), M.value.begin(), scaled);
  std::transform(exact.diagonal.begin(), exact.diagonal.end(), M.diagonal.begin(), scaled);
  return M;
}

template class ExactMatrix<2>;
template class ExactMatrix<3>;
template SymmetricBlocks<2> make_fine_matrix(const Matrix&, const NodeBlocks&, Real,
                                             ExactMatrix<2>&);
template SymmetricBlocks<3> make_fine_matrix(const Matrix&, const NodeBlocks&, Real,
                                             ExactMatrix<3>&);

}  // namespace frictioncg
