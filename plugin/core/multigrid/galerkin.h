#pragma once
#include "multigrid/block_matrix.h"

namespace frictioncg {

/// Rows of a symmetric matrix by their strictly lower blocks and half of their diagonal block: what
/// they contribute is X + X', so each block of the matrix belongs to one row. Rows [begin, end).
struct Rows {
  Index begin, end;
};

/// The places of P' A P, zero.
template <int B, int K>
SymmetricBlocks<K> galerkin_pattern(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P);

/// coarse += P' (X + X') P, where X are these rows of A.
template <int B, int K>
class GalerkinProduct {
 public:
  void add(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P, Rows rows,
           SymmetricBlocks<K>& coarse);

  /// Only these blocks of A: `lower` are indices of stored blocks, row by row; `rows` are rows
  /// whose diagonal block counts, and which own the lower blocks begin[q] .. begin[q+1]-1.
  void add(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P, const std::vector<Index>& rows,
           const std::vector<Index>& begin, const std::vector<Index>& lower,
           SymmetricBlocks<K>& coarse);

 private:
  void start_row(const Prolongation<B, K>& P);
  void multiply(float factor, const float* a, const Prolongation<B, K>& P, Index j);
  void scatter(const Prolongation<B, K>& P, Index i, SymmetricBlocks<K>& coarse);

  std::vector<Index> place_;    ///< of a coarse column in the present row of A P; -1: absent
  std::vector<Index> column_;   ///< of the present row of A P
  std::vector<float> product_;  ///< B x K for each column
};

}  // namespace frictioncg
