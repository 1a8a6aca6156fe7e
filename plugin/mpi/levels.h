#pragma once
#include "shared_matrix.h"

namespace frictioncg {

constexpr const char* petsc_prefix = "frictioncg_";  ///< of PETSc's options
constexpr PetscInt coarsest_level = 600;             ///< dofs of the coarsest of several levels

PetscInt rows_of(Mat A);
/// A bound on what is factorized, or that of PETSc's option for it.
PetscInt limited(PetscInt usual);

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

}  // namespace frictioncg
