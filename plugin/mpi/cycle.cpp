#include "hierarchy.h"

namespace frictioncg {

namespace {

constexpr Real overshoot = 1.7;  ///< of the smoother's correction, which diverges from 2 on

MPI_Comm communicator_of(Mat A) { return PetscObjectComm(reinterpret_cast<PetscObject>(A)); }

PetscMPIInt processes_of(Mat A) {
  PetscMPIInt processes;
  MPI_Comm_size(communicator_of(A), &processes);
  return processes;
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
  set_iteration(smoother, A, KSPRICHARDSON,
                static_cast<PetscInt>(dimension) + (processes_of(A) > 1));
  check(KSPGetPC(smoother, &pc));
  check(PCSetType(pc, PCSOR));
  check(PCSORSetSymmetric(pc, SOR_LOCAL_SYMMETRIC_SWEEP));
}

/// Before the coarse correction of a level, and after it; on the coarsest there is one solve.
std::vector<KSP> smoothers(PC cycle, PetscInt level) {
  std::vector<KSP> all(level > 0 ? 2 : 1);
  check(level > 0 ? PCMGGetSmootherDown(cycle, level, &all[0])
                  : PCMGGetCoarseSolve(cycle, &all[0]));
  if (level > 0) check(PCMGGetSmootherUp(cycle, level, &all[1]));
  return all;
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
/// numbers of a few conjugate gradients. Where these end before, as an indefinite A and an exact
/// answer have it, PETSc's numbers are of memory that nothing has filled, others on each process:
/// then nothing is damped.   Collective.
Real largest_eigenvalue(KSP smoother, Mat A) {
  constexpr PetscInt few = 10;
  KSPHandle cg;
  VecHandle x, b;
  Real largest, least;
  KSPConvergedReason reason;
  check(KSPCreate(communicator_of(A), cg.fill()));
  PC correction;
  set_iteration(cg.get(), A, KSPCG, few);
  check(KSPGetPC(smoother, &correction));
  check(KSPSetPC(cg.get(), correction));
  check(KSPSetConvergenceTest(cg.get(), KSPConvergedSkip, nullptr, nullptr));
  check(KSPSetComputeSingularValues(cg.get(), PETSC_TRUE));
  check(MatCreateVecs(A, x.fill(), b.fill()));
  check(VecSetRandom(x.get(), nullptr));
  check(MatMult(A, x.get(), b.get()));  // in the range of A, which may be singular
  check(KSPSolve(cg.get(), b.get(), x.get()));
  check(KSPGetConvergedReason(cg.get(), &reason));
  if (reason != KSP_CONVERGED_ITS) return overshoot;
  check(KSPComputeExtremeSingularValues(cg.get(), &largest, &least));
  return std::isfinite(largest) ? largest : overshoot;
}

/// By a factorization on one process; where aggregation has left too much for that, as on the other
/// levels.
void set_coarsest(KSP solver, const Level& coarsest, Index dimension) {
  Mat A = coarsest.truncated.get();
  if (!coarsest.exact) return set_smoother(solver, A, dimension);
  PC pc;
  check(KSPSetOperators(solver, A, A));
  check(KSPSetType(solver, KSPPREONLY));
  check(KSPGetPC(solver, &pc));
  check(PCSetType(pc, PCTELESCOPE));
  check(PCTelescopeSetReductionFactor(pc, processes_of(A)));
}

/// Pivots over the sums of their rows: below, A has a motion that is free there. PETSc's 2e-14
/// takes rounding for stiffness, and each cycle adds 1e13 times the rounding of r to such a motion.
constexpr Real zero_pivot = 1e-11;

/// On the one process, once the cycle is set up, which makes its solver there.
void set_factorization(PC cycle) {
  KSP inner = nullptr;
  PC pc;
  PetscBool on_one;
  check(KSPGetPC(smoothers(cycle, 0)[0], &pc));
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCTELESCOPE, &on_one));
  if (on_one) check(PCTelescopeGetKSP(pc, &inner));
  if (!inner) return;
  Mat A;
  Real norm;
  check(KSPGetOperators(inner, &A, nullptr));
  check(MatNorm(A, NORM_INFINITY, &norm));
  check(KSPGetPC(inner, &pc));
  check(PCSetType(pc, PCLU));
  check(PCFactorSetShiftType(pc, MAT_SHIFT_NONZERO));
  check(PCFactorSetZeroPivot(pc, zero_pivot));
  check(PCFactorSetShiftAmount(pc, zero_pivot * norm));  // at once, not by doubling
  check(KSPSetFromOptions(inner));
}

}  // namespace

PCHandle make_cycle(const std::vector<Level>& levels, Index dimension) {
  const PetscInt count = static_cast<PetscInt>(levels.size());
  Mat fine = levels.front().truncated.get();
  PCHandle cycle;
  check(PCCreate(communicator_of(fine), cycle.fill()));
  PC pc = cycle.get();
  check(PCSetOptionsPrefix(pc, petsc_prefix));
  check(PCSetType(pc, PCMG));
  check(PCSetOperators(pc, fine, fine));
  check(PCMGSetLevels(pc, count, nullptr));
  check(PCMGSetGalerkin(pc, PC_MG_GALERKIN_NONE));
  for (PetscInt l = 1; l < count; ++l) {
    const Level& level = levels[count - 1 - l];
    check(PCMGSetInterpolation(pc, l, level.P.get()));
    for (KSP smoother : smoothers(pc, l)) set_smoother(smoother, level.truncated.get(), dimension);
  }
  set_coarsest(smoothers(pc, 0)[0], levels.back(), dimension);
  // of one level alone, too: PETSc takes it for a smoother
  check(
      KSPSetOptionsPrefix(smoothers(pc, 0)[0], (std::string(petsc_prefix) + "mg_coarse_").c_str()));
  check(PCSetFromOptions(pc));
  for (PetscInt l = 0; l < count; ++l)
    for (KSP smoother : smoothers(pc, l)) check(KSPSetFromOptions(smoother));
  return cycle;
}

void settle(PC cycle, const std::vector<Level>& levels) {
  const PetscInt count = static_cast<PetscInt>(levels.size());
  for (PetscInt l = 0; l < count; ++l) {
    Mat A = levels[count - 1 - l].truncated.get();
    if (processes_of(A) == 1) continue;
    const std::vector<KSP> all = smoothers(cycle, l);
    if (!may_be_damped(all[0])) continue;
    const Real most = largest_eigenvalue(all[0], A);
    if (most <= overshoot) continue;
    for (KSP smoother : all) check(KSPRichardsonSetScale(smoother, overshoot / most));
  }
  check(PCSetUp(cycle));
  set_factorization(cycle);
  check(PCViewFromOptions(cycle, nullptr, "-pc_view"));
}

}  // namespace frictioncg
