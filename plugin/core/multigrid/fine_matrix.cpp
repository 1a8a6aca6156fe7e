#include "multigrid/fine_matrix.h"

#include "multigrid/block_index.h"

namespace frictioncg {

template <int D>
SymmetricBlocks<D> make_fine_matrix(const Matrix& A, const NodeBlocks& blocks, Real factor,
                                    ExactMatrix<D>& exact) {
  const Index* begin = A.outerIndexPtr();
  const Index* col = A.innerIndexPtr();
  const Real* a = A.valuePtr();
  SymmetricBlocks<D> M;
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
      for (Index e = begin[p]; e < begin[p + 1]; ++e) visit(r, e);
    }
  };
  for (Index i = 0; i < blocks.blocks; ++i) {
    const std::size_t first = M.col.size();
    for_each_entry(i, [&](Index, Index e) {
      const Index j = block_of[col[e]];
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
      const Index j = block_of[col[e]], c = blocks.slot[col[e]] - j * D;
      if (j < i)
        exact.lower[(std::size_t(place[j]) * D + r) * D + c] = a[e];
      else if (j == i)
        exact.diagonal[(std::size_t(i) * D + r) * D + c] = a[e];
    });
  }
  const auto scaled = [factor](Real entry) { return static_cast<float>(factor * entry); };
  M.value.resize(exact.lower.size());
  std::transform(exact.lower.begin(), exact.lower.end(), M.value.begin(), scaled);
  std::transform(exact.diagonal.begin(), exact.diagonal.end(), M.diagonal.begin(), scaled);
  return M;
}

template SymmetricBlocks<2> make_fine_matrix(const Matrix&, const NodeBlocks&, Real,
                                             ExactMatrix<2>&);
template SymmetricBlocks<3> make_fine_matrix(const Matrix&, const NodeBlocks&, Real,
                                             ExactMatrix<3>&);

}  // namespace frictioncg
