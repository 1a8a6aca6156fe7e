#include "levels.h"

#include <array>
#include <cmath>
#include <string>

namespace frictioncg {

namespace {

constexpr PetscInt coarsest = 600;              ///< dofs up to which one factorization does
constexpr PetscInt most_levels = 15;            ///< what PETSc allows
constexpr Real weak_2D = 0.02, weak_3D = 0.01;  ///< couplings below are not aggregated along
constexpr Real overshoot = 1.7;  ///< of the smoother's correction, which diverges from 2 on
constexpr const char* prefix = "frictioncg_";            ///< of PETSc's options
constexpr const char* discarded = "frictioncg_unused_";  ///< of what GAMG makes and we do not keep

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

/// GAMG gives levels and prolongations alone, whose cycle is made anew: options that would be read
/// and change nothing, or take away what this needs.
void refuse_options_without_effect() {
  for (const char* name :
       {"-pc_type", "-pc_mg_levels", "-pc_mg_galerkin", "-pc_gamg_use_sa_esteig",
        "-pc_gamg_recompute_esteig", "-pc_gamg_asm_use_agg", "-pc_gamg_reuse_interpolation",
        "-pc_gamg_parallel_coarse_grid_solver"}) {
    PetscBool given = PETSC_FALSE;
    check(PetscOptionsHasName(nullptr, prefix, name, &given));
    if (given)
      throw IllegalInput("PETSc's option -" + std::string(prefix) + (name + 1) +
                         " has no meaning here: GAMG makes levels and prolongations alone; leave "
                         "it out, and set the cycle by -" +
                         prefix + "mg_levels_... and -" + prefix + "mg_coarse_...");
  }
}

}  // namespace

/// Levels and prolongations by GAMG, which is then given up: a change of the matrix would make it
/// begin anew.
std::vector<Level> make_levels(const SharedMatrix& A, const Eigen::MatrixXd& modes) {
  refuse_options_without_effect();
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
  set_rings(gamg.get(), A.numbering().dimension);    // here: PETSc 3.18 has set its own before
  check(PCSetOptionsPrefix(gamg.get(), discarded));  // its smoothers do not serve
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

void set_iteration(KSP ksp, Mat A, KSPType type, PetscInt iterations) {
  check(KSPSetOperators(ksp, A, A));
  check(KSPSetType(ksp, type));
  check(KSPSetNormType(ksp, KSP_NORM_NONE));
  check(KSPSetTolerances(ksp, 0, 0, PETSC_DEFAULT, iterations));
}

/// Symmetric Gauss-Seidel within each process. Sweeps before and after: more in 3D, where the
/// aggregates are larger, and one more where each process sweeps its own part alone.
void set_smoother(KSP smoother, Mat A, Index dimension) {
  PC pc;
  set_iteration(smoother, A, KSPRICHARDSON, static_cast<PetscInt>(dimension) + of_several(A));
  check(KSPGetPC(smoother, &pc));
  check(PCSetType(pc, PCSOR));
  check(PCSORSetSymmetric(pc, SOR_LOCAL_SYMMETRIC_SWEEP));
}

/// Before the coarse correction of a level, and after it.
std::array<KSP, 2> smoothers(PC cycle, PetscInt level) {
  std::array<KSP, 2> both{};
  check(PCMGGetSmootherDown(cycle, level, &both[0]));
  check(PCMGGetSmootherUp(cycle, level, &both[1]));
  return both;
}

/// Whether a smoother's corrections have a scale, and PETSc's options do not set it.
bool may_be_damped(KSP smoother) {
  PetscBool scales, scaled;
  const char* own = nullptr;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(smoother), KSPRICHARDSON, &scales));
  if (!scales) return false;
  check(KSPGetOptionsPrefix(smoother, &own));
  check(PetscOptionsHasName(nullptr, own, "-ksp_richardson_scale", &scaled));
  return !scaled;
}

/// Of a smoother's correction of A; of Gauss-Seidel's on one process it is 1. By the Lanczos
/// numbers of a few conjugate gradients.   Collective.
Real largest_eigenvalue(KSP smoother, Mat A) {
  constexpr PetscInt few = 10;
  KSPHandle cg;
  VecHandle x, b;
  Real largest, least;
  check(KSPCreate(PetscObjectComm(reinterpret_cast<PetscObject>(A)), cg.fill()));
  PC correction;
  set_iteration(cg.get(), A, KSPCG, few);
  check(KSPGetPC(smoother, &correction));
  check(KSPSetPC(cg.get(), correction));
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
  check(PCSetOptionsPrefix(pc, prefix));
  check(PCSetType(pc, PCMG));
  check(PCSetOperators(pc, fine, fine));
  check(PCMGSetLevels(pc, count, nullptr));
  check(PCMGSetGalerkin(pc, PC_MG_GALERKIN_NONE));
  for (PetscInt l = 1; l < count; ++l) {
    const Level& level = levels[count - 1 - l];
    check(PCMGSetInterpolation(pc, l, level.P.get()));
    for (KSP smoother : smoothers(pc, l)) set_smoother(smoother, level.truncated.get(), dimension);
  }
  KSP solver;
  check(PCMGGetCoarseSolve(pc, &solver));
  set_coarsest(solver, levels.back().truncated.get());
  check(PCSetFromOptions(pc));
  check(KSPSetFromOptions(solver));
  for (PetscInt l = 1; l < count; ++l)
    for (KSP smoother : smoothers(pc, l)) check(KSPSetFromOptions(smoother));
  return cycle;
}

void settle(PC cycle, const std::vector<Level>& levels) {
  const PetscInt count = static_cast<PetscInt>(levels.size());
  for (PetscInt l = 1; l < count; ++l) {
    Mat A = levels[count - 1 - l].truncated.get();
    if (!of_several(A)) continue;
    const auto [down, up] = smoothers(cycle, l);
    if (!may_be_damped(down)) continue;
    const Real most = largest_eigenvalue(down, A);
    if (most <= overshoot) continue;
    for (KSP smoother : {down, up}) check(KSPRichardsonSetScale(smoother, overshoot / most));
  }
  check(PCSetUp(cycle));  // what the coarsest solve has inside reads its options here
  check(PCViewFromOptions(cycle, nullptr, "-pc_view"));
}

}  // namespace frictioncg
