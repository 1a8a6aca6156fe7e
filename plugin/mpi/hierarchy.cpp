#include "hierarchy.h"

namespace frictioncg {

namespace {

/// Of diagonal entries over what they were: nothing is left.
constexpr Real vanished = 1e-10;

class SharedHierarchy final : public Hierarchy {
 public:
  SharedHierarchy(std::shared_ptr<const SharedMatrix> A, const Eigen::MatrixXd& modes,
                  Coarsening coarsening)
      : A_(std::move(A)) {
    const Timed timed(Phase::hierarchy);
    level_ = make_levels(*A_, modes, coarsening);
    check(MatCreateVecs(A_->matrix(), r_.fill(), z_.fill()));
    check(VecSet(r_.get(), 0));
    check(VecDuplicate(r_.get(), mask_.fill()));
    check(MatDuplicate(A_->contact(), MAT_DO_NOT_COPY_VALUES, E_.fill()));
    cycle_ = make_cycle(level_, A_->numbering().dimension);
  }
  void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) override {
    const Timed timed(Phase::faces);
    fixed_ = fixed;
    Real* mask;
    check(VecSet(mask_.get(), 1));
    check(VecGetArray(mask_.get(), &mask));
    for (std::size_t c = 0; c < fixed.size(); ++c)
      if (fixed[c]) mask[A_->numbering().contact_slot(c)] = 0;
    check(VecRestoreArray(mask_.get(), &mask));
    fill_contact_part(W, springs);
    Mat change = E_.get();
    for (Index l = 0; l < levels(); ++l) {
      Level& level = level_[l];
      if (l > 0) {
        const MatReuse reuse = level.change.get() ? MAT_REUSE_MATRIX : MAT_INITIAL_MATRIX;
        check(MatPtAP(change, level_[l - 1].P.get(), reuse, PETSC_DEFAULT, level.change.fill()));
        change = level.change.get();
      }
      check(MatCopy(level.A.get(), level.truncated.get(), SAME_NONZERO_PATTERN));
      check(MatAXPY(level.truncated.get(), 1, change, SUBSET_NONZERO_PATTERN));
      fill_empty_rows(level);
    }
    if (!settled_) settle(cycle_.get(), level_);
    settled_ = true;
  }
  void apply(const Vector& r, Vector& z) override {
    const Timed timed(Phase::cycle);
    free_ = r;
    drop_fixed(fixed_, free_);
    A_->to_slots(free_, r_.get());
    check(PCApply(cycle_.get(), r_.get(), z_.get()));
    A_->from_slots(z_.get(), z);
    drop_fixed(fixed_, z);
  }
  Index levels() const override { return static_cast<Index>(level_.size()); }
  Real operator_complexity() const override {
    Real fine = 0, all = 0;
    for (const Level& level : level_) {
      MatInfo info;
      check(MatGetInfo(level.A.get(), MAT_GLOBAL_SUM, &info));
      all += info.nz_used;
      if (fine == 0) fine = info.nz_used;
    }
    return all / fine;
  }

 private:
  /// E = M (B + W) M - B.
  void fill_contact_part(const std::vector<TangentialStiffness>& W, const Vector& springs) {
    Mat B = A_->contact(), E = E_.get();
    const Numbering& N = A_->numbering();
    const auto slot = [&](Index c) { return N.first + N.contact_slot(c); };
    check(MatCopy(B, E, SAME_NONZERO_PATTERN));
    for (const TangentialStiffness& w : W) {
      const Index c = w.first - N.own_first.front();
      const PetscInt slots[] = {slot(c), slot(c + 1)};
      check(MatSetValues(E, 2, slots, 2, slots, w.M.data(), ADD_VALUES));
    }
    for (Index c = 0; c < springs.size(); ++c)
      check(MatSetValue(E, slot(c), slot(c), springs[c], ADD_VALUES));
    check(MatAssemblyBegin(E, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(E, MAT_FINAL_ASSEMBLY));
    check(MatDiagonalScale(E, mask_.get(), mask_.get()));
    check(MatAXPY(E, -1, B, SAME_NONZERO_PATTERN));
  }
  /// Rows of which the faces have left nothing get the diagonal they had, or 1.
  void fill_empty_rows(const Level& level) {
    VecHandle diagonal;
    PetscInt n;
    const Real* before;
    Real* now;
    check(VecDuplicate(level.diagonal.get(), diagonal.fill()));
    check(MatGetDiagonal(level.truncated.get(), diagonal.get()));
    check(VecGetLocalSize(diagonal.get(), &n));
    check(VecGetArrayRead(level.diagonal.get(), &before));
    check(VecGetArray(diagonal.get(), &now));
    for (PetscInt i = 0; i < n; ++i)
      if (!(now[i] > vanished * before[i])) now[i] = before[i] > 0 ? before[i] : 1;
    check(VecRestoreArrayRead(level.diagonal.get(), &before));
    check(VecRestoreArray(diagonal.get(), &now));
    check(MatDiagonalSet(level.truncated.get(), diagonal.get(), INSERT_VALUES));
  }

  std::shared_ptr<const SharedMatrix> A_;
  std::vector<Level> level_;  ///< from the finest to the coarsest
  PCHandle cycle_;
  bool settled_ = false;
  MatHandle E_;              ///< M B M - B + W
  VecHandle mask_;           ///< 0 on fixed dofs, else 1
  std::vector<char> fixed_;  ///< own contact dofs
  Vector free_;              ///< r without that of fixed dofs
  VecHandle r_, z_;
};

}  // namespace

std::unique_ptr<Hierarchy> shared_hierarchy(std::shared_ptr<const SharedMatrix> A,
                                            const Eigen::MatrixXd& modes, Coarsening coarsening) {
  return std::make_unique<SharedHierarchy>(std::move(A), modes, coarsening);
}

}  // namespace frictioncg
