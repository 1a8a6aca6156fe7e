#include "multigrid/smoother.h"

namespace frictioncg {

namespace {

/// In which order blocks are read: that of memory, or the reverse.
enum class Order { up, down };

/// visit(block, where its row of a vector begins) for the lower blocks of row i
template <Order order, int B, class Visit>
inline void for_each_lower(const SymmetricBlocks<B>& A, std::size_t i, const Visit& visit) {
  const auto at = [&](Index k) { visit(A.at(k), std::size_t(A.col[k]) * stride<B>); };
  if constexpr (order == Order::up)
    for (Index k = A.row[i]; k < A.row[i + 1]; ++k) at(k);
  else
    for (Index k = A.row[i + 1]; k-- > A.row[i];) at(k);
}

/// The sum of the lower blocks of row i with z
template <Order order, int B>
inline BlockSum<B, B> lower_product(const SymmetricBlocks<B>& A, std::size_t i, const float* z) {
  BlockSum<B, B> sum;
  for_each_lower<order>(A, i, [&](const float* a, std::size_t j) { sum.add(a, z + j); });
  return sum;
}

/// z_i = D^{-1} (r_i - L z); returns -z_i in minus.
template <Order order, int B>
inline void relax(const SymmetricBlocks<B>& A, std::size_t i, const float* r, float* z,
                  float* minus) {
  const BlockSum<B, B> lower = lower_product<order>(A, i, z);
  float rest[stride<B>] = {};
  for (int e = 0; e < B; ++e) rest[e] = r[i * stride<B> + e] - lower[e];
  BlockSum<B, B> z_i;
  z_i.add(A.inverse_at(i), rest);
  for (int e = 0; e < B; ++e) {
    z[i * stride<B> + e] = z_i[e];
    minus[e] = -z_i[e];
  }
  for (std::size_t e = B; e < stride<B>; ++e) z[i * stride<B> + e] = 0;
}

/// y -= L' z_i
template <Order order, int B>
inline void scatter(const SymmetricBlocks<B>& A, std::size_t i, const float* minus, float* y) {
  for_each_lower<order>(
      A, i, [&](const float* a, std::size_t j) { add_transposed_product<B, B>(a, minus, y + j); });
}

}  // namespace

template <int B>
void sweep_forward(const SymmetricBlocks<B>& A, float* residual, float* z) {
  A.parts.upwards([&](std::size_t first, std::size_t end) {
    float minus[B];
    for (std::size_t i = first; i < end; ++i) {
      relax<Order::up>(A, i, residual, z, minus);
      std::fill_n(residual + i * stride<B>, stride<B>, 0.0f);
      scatter<Order::up>(A, i, minus, residual);
    }
  });
}

template <int B>
void sweep_backward(const SymmetricBlocks<B>& A, float* r, float* z) {
  A.parts.downwards([&](std::size_t first, std::size_t end) {
    float minus[B];
    for (std::size_t i = end; i-- > first;) {
      relax<Order::down>(A, i, r, z, minus);
      scatter<Order::down>(A, i, minus, r);
    }
  });
}

template <int B>
void subtract_product(const SymmetricBlocks<B>& A, const float* r, const float* z,
                      float* residual) {
  A.parts.upwards([&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const std::size_t at = i * stride<B>;
      BlockSum<B, B> sum = lower_product<Order::up>(A, i, z);
      sum.add(A.diagonal_at(i), z + at);
      float minus[B];
      for (int e = 0; e < B; ++e) {
        residual[at + e] = r[at + e] - sum[e];
        minus[e] = -z[at + e];
      }
      scatter<Order::up>(A, i, minus, residual);
    }
  });
}

template <int R, int C>
void restrict_to(const Prolongation<R, C>& P, const float* fine, std::vector<float>& coarse,
                 std::vector<float>& sums) {
  const Index count = fixed_ranges(P.rows(), 8);  // each with a sum of its own
  sums.resize((count - 1) * coarse.size());
  in_ranges_of(P.rows(), count, [&](Index k, std::size_t first, std::size_t end) {
    float* sum = k == 0 ? coarse.data() : sums.data() + (k - 1) * coarse.size();
    std::fill_n(sum, coarse.size(), 0.0f);
    for (std::size_t i = first; i < end; ++i)
      for (Index q = P.row[i]; q < P.row[i + 1]; ++q)
        add_transposed_product<R, C>(P.at(q), fine + i * stride<R>,
                                     sum + std::size_t(P.col[q]) * stride<C>);
  });
  for (auto part = sums.begin(); part < sums.end(); part += std::ptrdiff_t(coarse.size()))
    std::transform(coarse.begin(), coarse.end(), part, coarse.begin(), std::plus<>());
}

template <int R, int C>
void prolong(const Prolongation<R, C>& P, const float* coarse, float* fine) {
  in_ranges(P.rows(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      BlockSum<R, C> sum;
      for (Index q = P.row[i]; q < P.row[i + 1]; ++q)
        sum.add(P.at(q), coarse + std::size_t(P.col[q]) * stride<C>);
      for (int r = 0; r < R; ++r) fine[i * stride<R> + r] += sum[r];
    }
  });
}

#define FRICTIONCG_INSTANTIATE(B)                                          \
  template void sweep_forward(const SymmetricBlocks<B>&, float*, float*);  \
  template void sweep_backward(const SymmetricBlocks<B>&, float*, float*); \
  template void subtract_product(const SymmetricBlocks<B>&, const float*, const float*, float*);
FRICTIONCG_BLOCKS(FRICTIONCG_INSTANTIATE)
#undef FRICTIONCG_INSTANTIATE
#define FRICTIONCG_INSTANTIATE(R, C)                                                      \
  template void restrict_to(const Prolongation<R, C>&, const float*, std::vector<float>&, \
                            std::vector<float>&);                                         \
  template void prolong(const Prolongation<R, C>&, const float*, float*);
FRICTIONCG_PROLONGATIONS(FRICTIONCG_INSTANTIATE)
#undef FRICTIONCG_INSTANTIATE

}  // namespace frictioncg
