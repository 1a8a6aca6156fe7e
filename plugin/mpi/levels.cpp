#include "levels.h"

namespace frictioncg {

namespace {

constexpr PetscInt coarsest = 600;              ///< dofs up to which one factorization does
constexpr PetscInt most_levels = 15;            ///< what PETSc allows
constexpr Real weak_2D = 0.02, weak_3D = 0.01;  ///< couplings below are not aggregated along
constexpr Real damping = 0.8;  ///< of Gauss-Seidel where there are several processes
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

/// Symmetric Gauss-Seidel within each process, before and after: more sweeps in 3D, where the
/// aggregates are larger. Several processes correct what they share more than once, and their sum
/// may overshoot by more than 2: it is damped, and one sweep more makes up for it.
void set_smoother(KSP smoother, Mat A, Index dimension) {
  PC pc;
  PetscMPIInt processes;
  MPI_Comm_size(PetscObjectComm(reinterpret_cast<PetscObject>(A)), &processes);
  const bool several = processes > 1;
  const PetscInt sweeps = static_cast<PetscInt>(dimension) + several;
  check(KSPSetOperators(smoother, A, A));
  check(KSPSetType(smoother, KSPRICHARDSON));
  if (several) check(KSPRichardsonSetScale(smoother, damping));
  check(KSPSetNormType(smoother, KSP_NORM_NONE));
  check(KSPSetTolerances(smoother, 0, 0, PETSC_DEFAULT, sweeps));
  check(KSPGetPC(smoother, &pc));
  check(PCSetType(pc, PCSOR));
  check(PCSORSetSymmetric(pc, SOR_LOCAL_SYMMETRIC_SWEEP));
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

}  // namespace frictioncg
