#pragma once
#include "multigrid/aggregation.h"

namespace frictioncg {

/// Near-kernel of a level: one row per slot, one column per mode; rows of empty slots are 0.
template <int K>
using Modes = Eigen::Matrix<Real, Eigen::Dynamic, K, Eigen::RowMajor>;

/// Piecewise rigid functions: on each aggregate an orthonormal basis of what the modes are there.
template <int B, int K>
struct Tentative {
  std::vector<float> value;  ///< B x K for each row; its column of blocks is the row's aggregate
  Modes<K> coarse;           ///< modes in that basis: tentative * coarse = modes
};

/// QR on each aggregate. A mode that depends on those before it on an aggregate (on a single node
/// rotations do) gets no function there: its column of the tentative and its row of the coarse
/// modes are 0.
template <int B, int K>
Tentative<B, K> make_tentative(const Aggregates& aggregates, const Modes<K>& modes);

/// Largest eigenvalue of D^{-1} A, D the diagonal blocks, by power steps: from below, to some
/// percent, with which damping stays stable.
template <int B>
float spectral_radius(const SymmetricBlocks<B>& A);

/// P = (I - omega D^{-1} A) P_tentative: one damped Jacobi step.
template <int B, int K>
Prolongation<B, K> smooth(const SymmetricBlocks<B>& A, const BlockGraph& graph,
                          const Aggregates& aggregates, const std::vector<float>& tentative,
                          float omega);

/// Inverts the diagonal blocks of these rows on the slots where they are positive: a slot whose
/// pivot is lost in rounding has nothing to be corrected, and gets zeros.
template <int B>
void invert_diagonal(SymmetricBlocks<B>& A, Index row);

}  // namespace frictioncg
