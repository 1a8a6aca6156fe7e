#include "multigrid/touched.h"

#include "multigrid/block_index.h"

namespace frictioncg {

namespace {

/// visit(pointer into A, offset into a compact copy) for each block.
template <int B, class Matrix_, class Visit>
void for_each_block(const Touched<B>& touched, Matrix_& A, Visit visit) {
  std::size_t offset = 0;
  for (const Index i : touched.rows) {
    visit(A.diagonal_at(i), offset);
    offset += B * B;
  }
  for (const Index k : touched.lower) {
    visit(A.at(k), offset);
    offset += B * B;
  }
}

}  // namespace

template <int B>
template <int R>
Touched<B> Touched<B>::reached(const SymmetricBlocks<R>& A, const Touched<R>& finer,
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

template <int B>
std::vector<float> Touched<B>::read(const SymmetricBlocks<B>& A) const {
  std::vector<float> values((rows.size() + lower.size()) * B * B);
  for_each_block(*this, A, [&](const float* a, std::size_t offset) {
    std::copy(a, a + B * B, values.begin() + offset);
  });
  return values;
}

template <int B>
void Touched<B>::add(float factor, const std::vector<float>& values, SymmetricBlocks<B>& A) const {
  for_each_block(*this, A, [&](float* a, std::size_t offset) {
    for (int e = 0; e < B * B; ++e) a[e] = factor * a[e] + values[offset + e];
  });
}

template <int B>
void Touched<B>::clear(SymmetricBlocks<B>& A) const {
  for_each_block(*this, A, [&](float* a, std::size_t) { std::fill(a, a + B * B, 0.0f); });
}

#define FRICTIONCG_INSTANTIATE(R, B)                                                    \
  template Touched<B> Touched<B>::reached(const SymmetricBlocks<R>&, const Touched<R>&, \
                                          const Prolongation<R, B>&, const SymmetricBlocks<B>&);
template class Touched<2>;
template class Touched<3>;
template class Touched<6>;
FRICTIONCG_PROLONGATIONS(FRICTIONCG_INSTANTIATE)
#undef FRICTIONCG_INSTANTIATE

}  // namespace frictioncg
