#include "multigrid/smoother.h"

namespace frictioncg {

namespace {

/// z_i = D^{-1} (r_i - L z); returns -z_i in minus.
template <int B>
inline void relax(const SymmetricBlocks<B>& A, std::size_t i, const float* r, float* z,
                  float* minus) {
  float rest[B] = {}, z_i[B] = {};
  for (Index k = A.row[i]; k < A.row[i + 1]; ++k)
    add_product<B, B>(A.at(k), z + std::size_t(A.col[k]) * B, rest);
  for (int e = 0; e < B; ++e) rest[e] = r[i * B + e] - rest[e];
  add_product<B, B>(A.inverse_at(i), rest, z_i);
  for (int e = 0; e < B; ++e) {
    z[i * B + e] = z_i[e];
    minus[e] = -z_i[e];
  }
}

/// y -= L' z_i
template <int B>
inline void scatter(const SymmetricBlocks<B>& A, std::size_t i, const float* minus, float* y) {
  for (Index k = A.row[i]; k < A.row[i + 1]; ++k)
    add_transposed_product<B, B>(A.at(k), minus, y + std::size_t(A.col[k]) * B);
}

}  // namespace

template <int B>
void sweep_forward(const SymmetricBlocks<B>& A, float* residual, float* z) {
  float minus[B];
  for (std::size_t i = 0; i < std::size_t(A.rows()); ++i) {
    relax(A, i, residual, z, minus);
    std::fill(residual + i * B, residual + (i + 1) * B, 0.0f);
    scatter(A, i, minus, residual);
  }
}

template <int B>
void sweep_backward(const SymmetricBlocks<B>& A, float* r, float* z) {
  float minus[B];
  for (std::size_t i = A.rows(); i-- > 0;) {
    relax(A, i, r, z, minus);
    scatter(A, i, minus, r);
  }
}

template <int B>
void subtract_product(const SymmetricBlocks<B>& A, const float* r, const float* z,
                      float* residual) {
  for (std::size_t i = 0; i < std::size_t(A.rows()); ++i) {
    float sum[B] = {}, minus[B];
    add_product<B, B>(A.diagonal_at(i), z + i * B, sum);
    for (Index k = A.row[i]; k < A.row[i + 1]; ++k)
      add_product<B, B>(A.at(k), z + std::size_t(A.col[k]) * B, sum);
    for (int e = 0; e < B; ++e) {
      residual[i * B + e] = r[i * B + e] - sum[e];
      minus[e] = -z[i * B + e];
    }
    scatter(A, i, minus, residual);
  }
}

template <int R, int C>
void restrict_to(const Prolongation<R, C>& P, const float* fine, std::vector<float>& coarse) {
  std::fill(coarse.begin(), coarse.end(), 0.0f);
  for (std::size_t i = 0; i < std::size_t(P.rows()); ++i)
    for (Index q = P.row[i]; q < P.row[i + 1]; ++q)
      add_transposed_product<R, C>(P.at(q), fine + i * R,
                                   coarse.data() + std::size_t(P.col[q]) * C);
}

template <int R, int C>
void prolong(const Prolongation<R, C>& P, const float* coarse, float* fine) {
  for (std::size_t i = 0; i < std::size_t(P.rows()); ++i)
    for (Index q = P.row[i]; q < P.row[i + 1]; ++q)
      add_product<R, C>(P.at(q), coarse + std::size_t(P.col[q]) * C, fine + i * R);
}

#define FRICTIONCG_INSTANTIATE(B)                                          \
  template void sweep_forward(const SymmetricBlocks<B>&, float*, float*);  \
  template void sweep_backward(const SymmetricBlocks<B>&, float*, float*); \
  template void subtract_product(const SymmetricBlocks<B>&, const float*, const float*, float*);
FRICTIONCG_INSTANTIATE(2)
FRICTIONCG_INSTANTIATE(3)
FRICTIONCG_INSTANTIATE(6)
#undef FRICTIONCG_INSTANTIATE
#define FRICTIONCG_INSTANTIATE(R, C)                                                       \
  template void restrict_to(const Prolongation<R, C>&, const float*, std::vector<float>&); \
  template void prolong(const Prolongation<R, C>&, const float*, float*);
FRICTIONCG_INSTANTIATE(2, 3)
FRICTIONCG_INSTANTIATE(3, 3)
FRICTIONCG_INSTANTIATE(3, 6)
FRICTIONCG_INSTANTIATE(6, 6)
#undef FRICTIONCG_INSTANTIATE

}  // namespace frictioncg
