#pragma once
#include "multigrid/prolongation.h"

namespace frictioncg {

/// The blocks of a coarse matrix that contact dofs contribute to, A = base + contact part: only
/// they change with the faces. The rows own their diagonal block and some of their lower blocks.
template <int B>
class Touched {
 public:
  std::vector<Index> rows;
  std::vector<Index> begin{0};  ///< rows + 1, into lower
  std::vector<Index> lower;     ///< indices of stored blocks

  /// What P' X P reaches, X being the blocks `finer` of A.
  template <int R>
  static Touched reached(const SymmetricBlocks<R>& A, const Touched<R>& finer,
                         const Prolongation<R, B>& P, const SymmetricBlocks<B>& coarse);

  std::vector<float> read(const SymmetricBlocks<B>& A) const;
  /// A := factor A + values on these blocks
  void add(float factor, const std::vector<float>& values, SymmetricBlocks<B>& A) const;
  void clear(SymmetricBlocks<B>& A) const;
};

}  // namespace frictioncg
