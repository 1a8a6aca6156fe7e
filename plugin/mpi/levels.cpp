#include "levels.h"

#include <cmath>

namespace frictioncg {

namespace {

constexpr PetscInt coarsest = 600;              ///< dofs up to which one factorization does
constexpr PetscInt most_levels = 15;            ///< what PETSc allows
constexpr Real weak_2D = 0.02, weak_3D = 0.01;  ///< couplings below are not aggregated along
constexpr Real overshoot = 1.7;  ///< of the smoother's correction, which diverges from 2 on
constexpr const char* prefix = "frictioncg_";

Mat retained(Mat matrix) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  return matrix;
}

/// The rigid motions as vectors of slots, orthonormal; those that depend on others are left out.
std::vector<VecHandle> orthonormal(const SharedMatrix& A, const Eigen::MatrixXd& modes) {
  constexpr Real dependent = 1e-8;
  std::vector<VecHandle> basis;
  for (Index k = 0; k < modes.cols(); ++k) {
    VecHandle v;
    check(MatCreateVecs(A.matrix(), v.fill(), nullptr));
    check(VecSet(v.get(), 0));
    A.to_slots(modes.col(k), v.get());
    Real before, after;
    check(VecNorm(v.get(), NORM_2, &before));
    for (int pass = 0; pass < 2; ++pass)
      for (const VecHandle& b : basis) {
        Real along;
        check(VecDot(v.get(), b.get(), &along));
        check(VecAXPY(v.get(), -along, b.get()));
      }
    check(VecNorm(v.get(), NORM_2, &after));
    if (!(after > dependent * before)) continue;
    check(VecScale(v.get(), 1 / after));
    basis.push_back(std::move(v));
  }
  return basis;
}

void set_near_kernel(const SharedMatrix& A, const Eigen::MatrixXd& modes) {
  const std::vector<VecHandle> basis = orthonormal(A, modes);
  std::vector<Vec> vectors;
  for (const VecHandle& v : basis) vectors.push_back(v.get());
  MatNullSpace space;
  check(MatNullSpaceCreate(A.domain().communicator(), PETSC_FALSE,
                           static_cast<PetscInt>(vectors.size()), vectors.data(), &space));
  check(MatSetNearNullSpace(A.matrix(), space));
  check(MatNullSpaceDestroy(&space));
}

/// By default GAMG takes aggregates of two rings of neighbours on the finest level. In 2D they are
/// cheap but coarse: up to 1.6 times the iterations of aggregates of one ring. In 3D one ring would
/// fill the coarse matrices, at 2.5 times the time.
void set_rings(PC gamg, Index dimension) {
  PetscBool squared = PETSC_FALSE, aggressive = PETSC_FALSE;  // does the user say it?
  check(PetscOptionsHasName(nullptr, prefix, "-pc_gamg_square_graph", &squared));
  check(PetscOptionsHasName(nullptr, prefix, "-pc_gamg_aggressive_coarsening", &aggressive));
  if (dimension == 2 && !squared && !aggressive) check(PCGAMGSetAggressiveLevels(gamg, 0));
}

}  // namespace

/// Levels and prolongations by GAMG, which is then given up: a change of the matrix would make it
/// begin anew.
std::vector<Level> make_levels(const SharedMatrix& A, const Eigen::MatrixXd& modes) {
  set_near_kernel(A, modes);
  std::vector<Level> levels;
  PCHandle gamg;
  check(PCCreate(A.domain().communicator(), gamg.fill()));
  check(PCSetType(gamg.get(), PCGAMG));
  check(PCSetOperators(gamg.get(), A.matrix(), A.matrix()));
  check(PCGAMGSetType(gamg.get(), PCGAMGAGG));
  check(PCGAMGSetNSmooths(gamg.get(), 1));
  check(PCGAMGSetCoarseEqLim(gamg.get(), coarsest));
  check(PCGAMGSetNlevels(gamg.get(), most_levels));
  // Elements that are flat, as where a mesh is graded towards the contact, hang together across
  // their thickness: with aggregates along weak couplings, too, such a mesh in 2D took 30 times the
  // iterations. In 3D what is weak fills the coarse matrices, hence the smaller threshold.
  std::vector<Real> thresholds(most_levels, A.numbering().dimension == 2 ? weak_2D : weak_3D);
  check(PCGAMGSetThreshold(gamg.get(), thresholds.data(), most_levels));
  check(PCSetOptionsPrefix(gamg.get(), prefix));
  check(PCSetFromOptions(gamg.get()));
  set_rings(gamg.get(), A.numbering().dimension);  // here: PETSc 3.18 has set its own before
  check(PCSetUp(gamg.get()));
  PetscInt count;
  check(PCMGGetLevels(gamg.get(), &count));
  for (PetscInt l = count - 1; l >= 0; --l) {
    Level level;
    KSP smoother;
    Mat of_level, P;
    check(PCMGGetSmoother(gamg.get(), l, &smoother));
    check(KSPGetOperators(smoother, nullptr, &of_level));
    level.A = MatHandle(retained(of_level));
    check(MatDuplicate(of_level, MAT_COPY_VALUES, level.truncated.fill()));
    check(MatCreateVecs(of_level, level.diagonal.fill(), nullptr));
    check(MatGetDiagonal(of_level, level.diagonal.get()));
    if (l > 0) {
      check(PCMGGetInterpolation(gamg.get(), l, &P));
      level.P = MatHandle(retained(P));
    }
    // blocks of rank-deficient aggregates have no inverse of their own
    if (l < count - 1) check(MatSetOption(level.truncated.get(), MAT_USE_INODES, PETSC_FALSE));
    levels.push_back(std::move(level));
  }
  return levels;
}

namespace {

bool of_several(Mat A) {
  PetscMPIInt processes;
  MPI_Comm_size(PetscObjectComm(reinterpret_cast<PetscObject>(A)), &processes);
  return processes > 1;
}

/// Symmetric Gauss-Seidel within each process.
void set_iteration(KSP ksp, Mat A, KSPType type, PetscInt iterations) {
  PC pc;
  check(KSPSetOperators(ksp, A, A));
  check(KSPSetType(ksp, type));
  check(KSPSetNormType(ksp, KSP_NORM_NONE));
  check(KSPSetTolerances(ksp, 0, 0, PETSC_DEFAULT, iterations));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCSOR));
  check(PCSORSetSymmetric(pc, SOR_LOCAL_SYMMETRIC_SWEEP));
}

/// Sweeps before and after: more in 3D, where the aggregates are larger, and one more where each
/// process sweeps its own part alone.
void set_smoother(KSP smoother, Mat A, Index dimension) {
  set_iteration(smoother, A, KSPRICHARDSON, static_cast<PetscInt>(dimension) + of_several(A));
}

/// Of Gauss-Seidel's correction of A: 1 on one process. By the Lanczos numbers of a few conjugate
/// gradients.   Collective.
Real largest_eigenvalue(Mat A) {
  constexpr PetscInt few = 10;
  KSPHandle cg;
  VecHandle x, b;
  Real largest, least;
  check(KSPCreate(PetscObjectComm(reinterpret_cast<PetscObject>(A)), cg.fill()));
  set_iteration(cg.get(), A, KSPCG, few);
  check(KSPSetComputeSingularValues(cg.get(), PETSC_TRUE));
  check(MatCreateVecs(A, x.fill(), b.fill()));
  check(VecSetRandom(x.get(), nullptr));
  check(MatMult(A, x.get(), b.get()));  // in the range of A, which may be singular
  check(KSPSolve(cg.get(), b.get(), x.get()));
  check(KSPComputeExtremeSingularValues(cg.get(), &largest, &least));
  return std::isfinite(largest) ? largest : overshoot;
}

/// By a factorization on each process: small.
void set_coarsest(KSP solver, Mat A) {
  PC pc, factor;
  KSP inner;
  check(KSPSetOperators(solver, A, A));
  check(KSPSetType(solver, KSPPREONLY));
  check(KSPGetPC(solver, &pc));
  check(PCSetType(pc, PCREDUNDANT));
  check(PCRedundantGetKSP(pc, &inner));
  check(KSPGetPC(inner, &factor));
  check(PCSetType(factor, PCLU));
  check(PCFactorSetShiftType(factor, MAT_SHIFT_NONZERO));
}

}  // namespace

PCHandle make_cycle(const std::vector<Level>& levels, Index dimension) {
  const PetscInt count = static_cast<PetscInt>(levels.size());
  Mat fine = levels.front().truncated.get();
  PCHandle cycle;
  check(PCCreate(PetscObjectComm(reinterpret_cast<PetscObject>(fine)), cycle.fill()));
  PC pc = cycle.get();
  check(PCSetType(pc, PCMG));
  check(PCSetOperators(pc, fine, fine));
  check(PCMGSetLevels(pc, count, nullptr));
  check(PCMGSetGalerkin(pc, PC_MG_GALERKIN_NONE));
  for (PetscInt l = 1; l < count; ++l) {
    const Level& level = levels[count - 1 - l];
    KSP down, up;
    check(PCMGSetInterpolation(pc, l, level.P.get()));
    check(PCMGGetSmootherDown(pc, l, &down));
    check(PCMGGetSmootherUp(pc, l, &up));
    set_smoother(down, level.truncated.get(), dimension);
    set_smoother(up, level.truncated.get(), dimension);
  }
  KSP solver;
  check(PCMGGetCoarseSolve(pc, &solver));
  set_coarsest(solver, levels.back().truncated.get());
  return cycle;
}

void damp(PC cycle, const std::vector<Level>& levels) {
  if (!of_several(levels.front().A.get())) return;
  const PetscInt count = static_cast<PetscInt>(levels.size());
  for (PetscInt l = 1; l < count; ++l) {
    KSP down, up;
    const Real most = largest_eigenvalue(levels[count - 1 - l].truncated.get());
    if (most <= overshoot) continue;
    check(PCMGGetSmootherDown(cycle, l, &down));
    check(PCMGGetSmootherUp(cycle, l, &up));
    for (KSP smoother : {down, up}) check(KSPRichardsonSetScale(smoother, overshoot / most));
  }
}

}  // namespace frictioncg
