#pragma once
#include "multigrid/hierarchy.h"
#include "levels.h"

namespace frictioncg {

/// Smoothed aggregation of PETSc's (GAMG) for A of all processes, and its cycle (PCMG) with the
/// contact faces cut out on every level:
///
///   fine level     M A M + W, with the diagonal of A on fixed dofs
///   coarse levels  A_1 + P_0'(M B M - B + W) P_0,  A_2 + P_1' dA_1 P_1, ...
///
/// B: entries of A in rows or columns of contact dofs; M drops the fixed ones. P and A_1, A_2 come
/// from A, once. The coarse levels see M P_0; on the fine one, rows of fixed dofs are uncoupled,
/// and what they carry is dropped before and after the cycle.
///
/// modes: rigid motions of the own dofs (own x k), the same combinations on all processes.
/// Collective.
std::unique_ptr<Hierarchy> shared_hierarchy(std::shared_ptr<const SharedMatrix> A,
                                            const Eigen::MatrixXd& modes, Coarsening coarsening);

}  // namespace frictioncg
