#include "hierarchy.h"

namespace frictioncg {

namespace {

PetscInt rows_of(Mat A) {
  PetscInt rows;
  check(MatGetSize(A, &rows, nullptr));
  return rows;
}

/// A bound on what is factorized, or that of PETSc's option for it.
PetscInt limited(PetscInt usual) {
  check(PetscOptionsGetInt(nullptr, petsc_prefix, "-pc_gamg_coarse_eq_limit", &usual, nullptr));
  return usual;
}

constexpr PetscInt coarsest_level = 600;  ///< dofs of the coarsest of several levels
constexpr PetscInt stalled = 10;  ///< over that: aggregation has found no couplings to go on with
/// Dofs up to which the whole is factorized where multigrid does not arrive: some seconds a step.
constexpr PetscInt last_2D = 30000, last_3D = 8000;

/// Dofs up to which the whole is factorized: aggregates are large for a body of few elements, and
/// took three times the iterations where nu = 0.49.
constexpr PetscInt direct_2D = 3000, direct_3D = 1500;
constexpr PetscInt most_levels = 15;            ///< what PETSc allows
constexpr Real weak_2D = 0.02, weak_3D = 0.01;  ///< couplings below are not aggregated along
constexpr const char* discarded = "frictioncg_unused_";  ///< of what GAMG makes and we do not keep

Mat retained(Mat matrix) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  return matrix;
}

/// The rigid motions as vectors of slots, orthonormal; those that depend on others are left out.
void set_near_kernel(const SharedMatrix& A, const Eigen::MatrixXd& modes) {
  constexpr Real dependent = 1e-8;
  std::vector<VecHandle> basis;
  std::vector<Vec> vectors;  // the same
  for (Index k = 0; k < modes.cols(); ++k) {
    VecHandle v;
    check(MatCreateVecs(A.matrix(), v.fill(), nullptr));
    check(VecSet(v.get(), 0));
    A.to_slots(modes.col(k), v.get());
    Real before, after;
    check(VecNorm(v.get(), NORM_2, &before));
    for (int pass = 0; pass < 2; ++pass)
      for (Vec b : vectors) {
        Real along;
        check(VecDot(v.get(), b, &along));
        check(VecAXPY(v.get(), -along, b));
      }
    check(VecNormalize(v.get(), &after));
    if (!(after > dependent * before)) continue;
    vectors.push_back(v.get());
    basis.push_back(std::move(v));
  }
  MatNullSpace space;
  check(MatNullSpaceCreate(A.domain().communicator(), PETSC_FALSE,
                           static_cast<PetscInt>(vectors.size()), vectors.data(), &space));
  check(MatSetNearNullSpace(A.matrix(), space));
  check(MatNullSpaceDestroy(&space));
}

bool has_at_most(const SharedMatrix& A, PetscInt in_2D, PetscInt in_3D) {
  return rows_of(A.matrix()) <= (A.numbering().dimension == 2 ? in_2D : in_3D);
}

/// GAMG gives levels and prolongations alone, whose cycle is made anew: options that would be read
/// and change nothing, or take away what this needs.
void refuse_options_without_effect() {
  for (const char* name :
       {"-pc_type", "-pc_mg_levels", "-pc_mg_galerkin", "-pc_gamg_use_sa_esteig",
        "-pc_gamg_recompute_esteig", "-pc_gamg_asm_use_agg", "-pc_gamg_reuse_interpolation",
        "-pc_gamg_parallel_coarse_grid_solver"}) {
    PetscBool given = PETSC_FALSE;
    check(PetscOptionsHasName(nullptr, petsc_prefix, name, &given));
    if (given)
      refuse("PETSc's option -", petsc_prefix, (name + 1),
             " has no meaning here: GAMG makes levels and prolongations alone; leave "
             "it out, and set the cycle by -",
             petsc_prefix, "mg_levels_... and -", petsc_prefix, "mg_coarse_...");
  }
}

PCHandle make_gamg(const SharedMatrix& A) {
  PCHandle gamg;
  check(PCCreate(A.domain().communicator(), gamg.fill()));
  check(PCSetType(gamg.get(), PCGAMG));
  check(PCSetOperators(gamg.get(), A.matrix(), A.matrix()));
  check(PCGAMGSetType(gamg.get(), PCGAMGAGG));
  check(PCGAMGSetNSmooths(gamg.get(), 1));
  check(PCGAMGSetCoarseEqLim(gamg.get(), coarsest_level));
  check(PCGAMGSetNlevels(gamg.get(), most_levels));
  // Elements that are flat, as where a mesh is graded towards the contact, hang together across
  // their thickness: with aggregates along weak couplings, too, such a mesh in 2D took 30 times the
  // iterations. In 3D what is weak fills the coarse matrices, hence the smaller threshold.
  std::vector<Real> thresholds(most_levels, A.numbering().dimension == 2 ? weak_2D : weak_3D);
  check(PCGAMGSetThreshold(gamg.get(), thresholds.data(), most_levels));
  check(PCSetOptionsPrefix(gamg.get(), petsc_prefix));
  check(PCSetFromOptions(gamg.get()));
  // By default GAMG takes aggregates of two rings of neighbours on the finest level. In 2D they are
  // cheap but coarse: up to 1.6 times the iterations of aggregates of one ring. In 3D one ring
  // would fill the coarse matrices, at 2.5 times the time. Here: PETSc 3.18 has set its own before.
  PetscBool squared = PETSC_FALSE, aggressive = PETSC_FALSE;  // does the user say it?
  check(PetscOptionsHasName(nullptr, petsc_prefix, "-pc_gamg_square_graph", &squared));
  check(PetscOptionsHasName(nullptr, petsc_prefix, "-pc_gamg_aggressive_coarsening", &aggressive));
  if (A.numbering().dimension == 2 && !squared && !aggressive)
    check(PCGAMGSetAggressiveLevels(gamg.get(), 0));
  check(PCSetOptionsPrefix(gamg.get(), discarded));  // its smoothers do not serve
  // PETSc's eigenvalues of conjugate gradients that an indefinite A ends before their time are of
  // memory that nothing has filled, and may be looked for without end.
  const std::string estimate = std::string("-") + discarded + "pc_gamg_esteig_ksp_type";
  check(PetscOptionsSetValue(nullptr, estimate.c_str(), KSPGMRES));
  check(PCSetUp(gamg.get()));
  check(PetscOptionsClearValue(nullptr, estimate.c_str()));
  return gamg;
}

Level level_of(Mat A) {
  Level level;
  level.A = MatHandle(retained(A));
  check(MatDuplicate(A, MAT_COPY_VALUES, level.truncated.fill()));
  check(MatCreateVecs(A, level.diagonal.fill(), nullptr));
  check(MatGetDiagonal(A, level.diagonal.get()));
  return level;
}

}  // namespace

/// Levels and prolongations by GAMG, which is then given up: a change of the matrix would make it
/// begin anew.
std::vector<Level> make_levels(const SharedMatrix& A, const Eigen::MatrixXd& modes,
                               Coarsening coarsening) {
  refuse_options_without_effect();
  std::vector<Level> levels;
  if (coarsening == Coarsening::none || has_at_most(A, limited(direct_2D), limited(direct_3D))) {
    levels.push_back(level_of(A.matrix()));
    levels.back().exact = true;
    return levels;
  }
  set_near_kernel(A, modes);
  const PCHandle gamg = make_gamg(A);
  PetscInt count;
  check(PCMGGetLevels(gamg.get(), &count));
  for (PetscInt l = count - 1; l >= 0; --l) {
    KSP smoother;
    Mat of_level, P;
    check(PCMGGetSmoother(gamg.get(), l, &smoother));
    check(KSPGetOperators(smoother, nullptr, &of_level));
    Level level = level_of(of_level);
    if (l > 0) {
      check(PCMGGetInterpolation(gamg.get(), l, &P));
      level.P = MatHandle(retained(P));
    }
    // blocks of rank-deficient aggregates have no inverse of their own
    if (l < count - 1) check(MatSetOption(level.truncated.get(), MAT_USE_INODES, PETSC_FALSE));
    levels.push_back(std::move(level));
  }
  levels.back().exact = rows_of(levels.back().A.get()) <= stalled * limited(coarsest_level);
  return levels;
}

bool may_be_factorized(const SharedMatrix& A) { return has_at_most(A, last_2D, last_3D); }

}  // namespace frictioncg
