#pragma once
#include "multigrid/hierarchy.h"
#include "shared_matrix.h"

namespace frictioncg {

enum class Coarsening { aggregation, none };

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

// What it is made of.

constexpr const char* petsc_prefix = "frictioncg_";  ///< of PETSc's options
/// A level of the hierarchy of A.
struct Level {
  MatHandle A;          ///< of the untruncated matrix
  MatHandle truncated;  ///< what the cycle works on
  MatHandle P;          ///< from the next coarser level; none on the coarsest
  MatHandle change;     ///< truncated - A; none on the finest
  VecHandle diagonal;   ///< of A
  bool exact = false;   ///< the coarsest: few enough dofs for a factorization on one process
};

/// From the finest to the coarsest. modes: as in shared_hierarchy.   Collective.
std::vector<Level> make_levels(const SharedMatrix& A, const Eigen::MatrixXd& modes,
                               Coarsening coarsening);

/// Whether a factorization of A on one process is within reach, where multigrid does not arrive.
bool may_be_factorized(const SharedMatrix& A);

/// What is to be done once matrices are truncated. Where several processes correct what they share
/// more than once, their sum may overshoot, and the smoother diverges: damps it on the levels where
/// it would. Shows the cycle where PETSc's options ask for it.   Collective.
void settle(PC cycle, const std::vector<Level>& levels);

/// A V-cycle on the truncated matrices of the levels, or what PETSc's options make of it.
PCHandle make_cycle(const std::vector<Level>& levels, Index dimension);

}  // namespace frictioncg
