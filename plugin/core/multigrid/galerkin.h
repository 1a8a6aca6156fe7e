#pragma once
#include "multigrid/touched.h"

namespace frictioncg {

/// The places of P' A P, zero.
template <int B, int K>
SymmetricBlocks<K> galerkin_pattern(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P);

/// coarse += P' (X + X') P, A = X + X': rows of X have strictly lower blocks and half of the
/// diagonal one, so each block of A belongs to one row.
template <int B, int K>
class GalerkinProduct {
 public:
  void add(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P, SymmetricBlocks<K>& coarse);

  /// Only these blocks of A.
  void add(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P, const Touched<B>& of,
           SymmetricBlocks<K>& coarse);

 private:
  void start_row(const SymmetricBlocks<B>& A, const Prolongation<B, K>& P, Index i);
  void multiply(float factor, const float* a, const Prolongation<B, K>& P, Index j);
  void scatter(const Prolongation<B, K>& P, Index i, SymmetricBlocks<K>& coarse);

  std::vector<Index> place_;    ///< of a coarse column in the present row of A P; -1: absent
  std::vector<Index> column_;   ///< of the present row of A P
  std::vector<float> product_;  ///< B x K for each column
};

}  // namespace frictioncg
