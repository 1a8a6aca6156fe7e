#include "multigrid/galerkin.h"

#include "multigrid/block_index.h"

namespace frictioncg {

namespace {

bool are_zero(const float* begin, const float* end) {
  return std::all_of(begin, end, [](float a) { return a == 0; });
}

}  // namespace

template <int B, int K>
SymmetricBlocks<K> galerkin_pattern(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P) {
  std::vector<std::vector<Index>> lower(P.columns);
  std::vector<Index> reached, seen_by(P.columns, -1);
  for (Index i = 0; i < A.rows(); ++i) {
    reached.clear();
    const auto visit = [&](Index j) {
      for (Index q = P.row[j]; q < P.row[j + 1]; ++q)
        if (seen_by[P.col[q]] != i) seen_by[P.col[q]] = i, reached.push_back(P.col[q]);
    };
    visit(i);
    for (Index k = A.row[i]; k < A.row[i + 1]; ++k) visit(A.col[k]);
    for (Index q = P.row[i]; q < P.row[i + 1]; ++q)
      for (Index J : reached) {
        const Index I = P.col[q];
        if (I != J) lower[std::max(I, J)].push_back(std::min(I, J));
      }
  }
  SymmetricBlocks<K> coarse;
  for (std::vector<Index>& columns : lower) {
    sort_once(columns);
    coarse.col.insert(coarse.col.end(), columns.begin(), columns.end());
    coarse.row.push_back(to_block_index(coarse.col.size()));
    std::vector<Index>().swap(columns);
  }
  coarse.value.assign(coarse.col.size() * K * K, 0);
  coarse.diagonal.assign(std::size_t(P.columns) * K * K, 0);
  coarse.inverse.assign(std::size_t(P.columns) * K * K, 0);
  return coarse;
}

template <int B, int K>
void GalerkinProduct<B, K>::start_row(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P,
                                      Index i) {
  if (Index(place_.size()) < P.columns) place_.resize(P.columns, -1);
  for (Index J : column_) place_[J] = -1;
  column_.clear();
  product_.clear();
  multiply(0.5f, A.diagonal_at(i), P, i);
}

/// The present row of A P += factor a P_j
template <int B, int K>
void GalerkinProduct<B, K>::multiply(float factor, const float* a, const Prolongation<B, K>& P,
                                     Index j) {
  if (are_zero(a, a + B * B)) return;
  for (Index q = P.row[j]; q < P.row[j + 1]; ++q) {
    Index& place = place_[P.col[q]];
    if (place < 0) {
      place = static_cast<Index>(column_.size());
      column_.push_back(P.col[q]);
      product_.resize(product_.size() + B * K, 0);
    }
    add_block_product<B, B, K>(factor, a, P.at(q), product_.data() + std::size_t(place) * B * K);
  }
}

/// coarse += P_i' T + T' P_i, T the present row of A P
template <int B, int K>
void GalerkinProduct<B, K>::scatter(const Prolongation<B, K>& P, Index i,
                                    SymmetricBlocks<K>& coarse) {
  for (Index q = P.row[i]; q < P.row[i + 1]; ++q) {
    const Index I = P.col[q];
    const float* p = P.at(q);
    for (std::size_t c = 0; c < column_.size(); ++c) {
      const Index J = column_[c];
      const float* t = product_.data() + c * B * K;
      if (I > J) {
        add_transposed_block_product<K, B, K>(1, p, t, coarse.at(coarse.find(I, J)));
      } else if (I < J) {
        add_transposed_block_product<K, B, K>(1, t, p, coarse.at(coarse.find(J, I)));
      } else {
        add_transposed_block_product<K, B, K>(1, p, t, coarse.diagonal_at(I));
        add_transposed_block_product<K, B, K>(1, t, p, coarse.diagonal_at(I));
      }
    }
  }
}

template <int B, int K>
void GalerkinProduct<B, K>::add(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P,
                                SymmetricBlocks<K>& coarse) {
  for (Index i = 0; i < A.rows(); ++i) {
    start_row(A, P, i);
    for (Index k = A.row[i]; k < A.row[i + 1]; ++k) multiply(1, A.at(k), P, A.col[k]);
    scatter(P, i, coarse);
  }
}

template <int B, int K>
void GalerkinProduct<B, K>::add(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P,
                                const Touched<B>& of, SymmetricBlocks<K>& coarse) {
  for (std::size_t q = 0; q < of.rows.size(); ++q) {
    const Index i = of.rows[q];
    if (are_zero(P.at(P.row[i]), P.at(P.row[i + 1]))) continue;  // a node that sticks
    start_row(A, P, i);
    for (Index k = of.begin[q]; k < of.begin[q + 1]; ++k)
      multiply(1, A.at(of.lower[k]), P, A.col[of.lower[k]]);
    scatter(P, i, coarse);
  }
}

#define FRICTIONCG_INSTANTIATE(B, K)                                       \
  template SymmetricBlocks<K> galerkin_pattern(const SymmetricBlocks<B>&,  \
                                               const Prolongation<B, K>&); \
  template class GalerkinProduct<B, K>;
FRICTIONCG_PROLONGATIONS(FRICTIONCG_INSTANTIATE)
#undef FRICTIONCG_INSTANTIATE

}  // namespace frictioncg
