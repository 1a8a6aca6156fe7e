#pragma once
#include "multigrid/block_matrix.h"

namespace frictioncg {

// Vectors have `stride` floats a row; what lies between rows is 0 in z.

/// One forward block Gauss-Seidel sweep on A z = residual from z = 0: (L + D) z = residual; leaves
/// in residual what remains, residual - A z = -L' z. One pass over the stored half of A: row i
/// takes L z for its own equation and gives L' z to those before it. Slots with a zero inverse stay
/// 0.
template <int B>
void sweep_forward(const SymmetricBlocks<B>& A, float* residual, float* z);

/// One backward sweep from z, the transpose of the forward one: (D + L') z_new = r - L z. r is
/// overwritten.
template <int B>
void sweep_backward(const SymmetricBlocks<B>& A, float* r, float* z);

/// residual = r - A z
template <int B>
void subtract_product(const SymmetricBlocks<B>& A, const float* r, const float* z, float* residual);

/// coarse = P' fine; sums is room for parts of it.
template <int R, int C>
void restrict_to(const Prolongation<R, C>& P, const float* fine, std::vector<float>& coarse,
                 std::vector<float>& sums);

/// fine += P coarse
template <int R, int C>
void prolong(const Prolongation<R, C>& P, const float* coarse, float* fine);

}  // namespace frictioncg
