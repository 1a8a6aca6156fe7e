#pragma once
#include "shared_matrix.h"

namespace frictioncg {

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

enum class Coarsening { aggregation, none };

/// From the finest to the coarsest. modes: as in SharedHierarchy.   Collective.
std::vector<Level> make_levels(const SharedMatrix& A, const Eigen::MatrixXd& modes,
                               Coarsening coarsening);

/// Whether a factorization of A on one process is within reach, where multigrid does not arrive.
bool may_be_factorized(const SharedMatrix& A);

}  // namespace frictioncg
