#pragma once
#include "shared_matrix.h"

namespace frictioncg {

/// A level of the hierarchy of A.
struct Level {
  MatHandle A;          ///< of the untruncated matrix
  MatHandle truncated;  ///< what the cycle works on
  MatHandle P;          ///< from the next coarser level; none on the coarsest
  MatHandle change;     ///< truncated - A; none on the finest
  VecHandle diagonal;   ///< of A
};

/// From the finest to the coarsest. modes: as in SharedHierarchy.   Collective.
std::vector<Level> make_levels(const SharedMatrix& A, const Eigen::MatrixXd& modes);

/// Where several processes correct what they share more than once, their sum may overshoot, and
/// the smoother diverge: damps it on the levels where it would. To be called with truncated
/// matrices.   Collective.
void damp(PC cycle, const std::vector<Level>& levels);

/// A V-cycle on the truncated matrices of the levels.
PCHandle make_cycle(const std::vector<Level>& levels, Index dimension);

}  // namespace frictioncg
