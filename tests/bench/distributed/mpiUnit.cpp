// Units of tests/bench/mpi3d.edp: what PETSc alone takes for the matrix of a contactproblem of
// several processes.
//   real[int] t = petscUnits(P)   [CG with GAMG to 1e-8: set-up and solve, s; its iterations; one
//   product A x, s]
#include "freefem/freefem.h"

#include "freefem/operators.h"
#include "mpi/shared_scene.h"

namespace frictioncg {
namespace {

constexpr int products = 20;
constexpr Real accuracy = 1e-8;

/// Conjugate gradients on A x = b for a b of ones; A is positive definite where supports hold the
/// body.
PetscInt solve_linear(Mat A, Vec b, Vec x) {
  KSP ksp;
  PC pc;
  PetscInt iterations;
  check(KSPCreate(PetscObjectComm(reinterpret_cast<PetscObject>(A)), &ksp));
  check(KSPSetOperators(ksp, A, A));
  check(KSPSetType(ksp, KSPCG));
  check(KSPSetTolerances(ksp, accuracy, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCGAMG));
  check(PCGAMGSetType(pc, PCGAMGAGG));
  check(PCGAMGSetNSmooths(pc, 1));
  check(PCSetFromOptions(pc));  // without it GAMG coarsens less, and costs twice as much
  check(KSPSolve(ksp, b, x));
  check(KSPGetIterationNumber(ksp, &iterations));
  check(KSPDestroy(&ksp));
  return iterations;
}

KN_<double> petsc_units(Stack stack, ContactProblemVariable* const& P) {
  const PosedProblem posed = posed_by(P);
  if (!posed.shared) ExecError("petscUnits: the contactproblem has no domain");
  const MPI_Comm all = posed.shared->domain->communicator();
  Mat A = posed.shared->A->matrix();
  VecHandle b, x;
  check(MatCreateVecs(A, b.fill(), x.fill()));
  check(VecSet(b.get(), 1));
  KN<double>& t = *Add2StackOfPtr2Free(stack, new KN<double>(3));
  MPI_Barrier(all);
  double start = MPI_Wtime();
  t[1] = solve_linear(A, b.get(), x.get());
  MPI_Barrier(all);
  t[0] = MPI_Wtime() - start;
  start = MPI_Wtime();
  for (int k = 0; k < products; ++k) check(MatMult(A, b.get(), x.get()));
  MPI_Barrier(all);
  t[2] = (MPI_Wtime() - start) / products;
  return t;
}

void load() {
  Global.Add("petscUnits", "(",
             new OneOperator1s_<KN_<double>, ContactProblemVariable*>(petsc_units));
}

}  // namespace
}  // namespace frictioncg

LOADFUNC(frictioncg::load)
