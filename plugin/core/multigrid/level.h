#pragma once
#include "multigrid/border.h"
#include "multigrid/prolongation.h"
#include "multigrid/touched.h"

namespace frictioncg {

/// One level of a hierarchy with B slots a row; the next one has K.
template <int B, int K>
struct Level {
  SymmetricBlocks<B> A;
  Prolongation<B, K> P;     ///< from the next level; none on the coarsest
  Touched<B> touched;       ///< blocks that the contact dofs contribute to
  std::vector<float> base;  ///< of the touched blocks, what the interior gives them
  std::vector<float> r, z, work, residual;
  std::vector<float> first_r, first_z;  ///< of the first of two cycles
  LevelBorder<B> border;

  void allocate() {
    for (std::vector<float>* v : {&r, &z, &work, &residual, &first_r, &first_z})
      v->assign(std::size_t(A.rows()) * stride<B>, 0);
  }
  double bytes() const;
};

/// Builds the level's P by smoothed aggregation; returns the modes of the next level. Thin layers
/// of elements are not aggregated across.
template <int B, int K>
Modes<K> coarsen(Level<B, K>& level, const Modes<K>& modes, Coarsening how);

/// next.A = P' A P, its base apart: level.A holds its own base in turn, and then, in the touched
/// blocks, the contact part alone. contact: that part of level.A, replaced by that of next.A.
template <int B, int K>
void make_next(Level<B, K>& level, Level<K, K>& next, std::vector<float>& contact);

}  // namespace frictioncg
