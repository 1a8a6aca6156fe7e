#include "hierarchy.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "cycle.h"

namespace frictioncg {

namespace {

constexpr Real vanished = 1e-10;  ///< diagonal entries over what they were: nothing is left

}  // namespace

SharedHierarchy::SharedHierarchy(std::shared_ptr<const SharedMatrix> A,
                                 const Eigen::MatrixXd& modes, Coarsening coarsening)
    : A_(std::move(A)) {
  const Timed timed(Phase::hierarchy);
  level_ = make_levels(*A_, modes, coarsening);
  check(MatCreateVecs(A_->matrix(), r_.fill(), z_.fill()));
  check(VecSet(r_.get(), 0));
  make_contact_part();
  cycle_ = make_cycle(level_, A_->numbering().dimension);
}

/// The pattern of E, and where its columns find their mask.
void SharedHierarchy::make_contact_part() {
  const ContactEntries& B = A_->contact();
  const PetscInt first = A_->numbering().first, n = A_->numbering().slots();
  std::map<PetscInt, PetscInt> ghost;
  for (PetscInt column : B.columns)
    if (column < first || column >= first + n) ghost.emplace(column, 0);
  std::vector<PetscInt> ghosts;
  for (auto& [column, place] : ghost) {
    place = n + static_cast<PetscInt>(ghosts.size());
    ghosts.push_back(column);
  }
  for (PetscInt column : B.columns)
    mask_of_.push_back(column < first || column >= first + n ? ghost.at(column) : column - first);
  check(VecCreateGhost(A_->domain().communicator(), n, PETSC_DETERMINE,
                       static_cast<PetscInt>(ghosts.size()), ghosts.data(), mask_.fill()));
  std::vector<PetscInt> own(n, 0), other(n, 0);
  for (std::size_t k = 0; k < B.rows.size(); ++k)
    for (std::size_t e = B.start[k]; e < B.start[k + 1]; ++e)
      ++(mask_of_[e] < n ? own : other)[B.rows[k] - first];
  check(MatCreate(A_->domain().communicator(), E_.fill()));
  check(MatSetSizes(E_.get(), n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetBlockSize(E_.get(), A_->numbering().dimension));
  check(MatSetType(E_.get(), MATAIJ));
  check(MatSeqAIJSetPreallocation(E_.get(), 0, own.data()));
  check(MatMPIAIJSetPreallocation(E_.get(), 0, own.data(), 0, other.data()));
}

void SharedHierarchy::set_mask(const std::vector<char>& fixed) {
  fixed_ = fixed;
  Vec local;
  Real* mask;
  check(VecGhostGetLocalForm(mask_.get(), &local));
  check(VecSet(local, 1));
  check(VecGetArray(local, &mask));
  const std::vector<PetscInt>& slot = A_->contact().contact_slot;
  for (std::size_t c = 0; c < fixed.size(); ++c)
    if (fixed[c]) mask[slot[c] - A_->numbering().first] = 0;
  check(VecRestoreArray(local, &mask));
  check(VecGhostRestoreLocalForm(mask_.get(), &local));
  check(VecGhostUpdateBegin(mask_.get(), INSERT_VALUES, SCATTER_FORWARD));
  check(VecGhostUpdateEnd(mask_.get(), INSERT_VALUES, SCATTER_FORWARD));
}

/// E = M (B + W) M - B.
void SharedHierarchy::fill_contact_part(const std::vector<TangentialStiffness>& W,
                                        const Vector& springs) {
  const ContactEntries& B = A_->contact();
  const std::vector<PetscInt>& slot = B.contact_slot;
  const PetscInt first = A_->numbering().first;
  const Index interior = A_->numbering().own_first.front();
  std::map<std::pair<PetscInt, PetscInt>, Real> laws;
  for (const TangentialStiffness& w : W)
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b)
        laws[{slot[w.first - interior + a], slot[w.first - interior + b]}] += w.M(a, b);
  for (Index c = 0; c < springs.size(); ++c) laws[{slot[c], slot[c]}] += springs[c];
  Vec local;
  const Real* mask;
  check(VecGhostGetLocalForm(mask_.get(), &local));
  check(VecGetArrayRead(local, &mask));
  std::vector<Real> row;
  for (std::size_t k = 0; k < B.rows.size(); ++k) {
    const Real of_row = mask[B.rows[k] - first];
    row.clear();
    for (std::size_t e = B.start[k]; e < B.start[k + 1]; ++e) {
      const auto law = laws.find({B.rows[k], B.columns[e]});
      const Real added = law == laws.end() ? 0 : law->second;
      row.push_back(of_row * mask[mask_of_[e]] * (B.values[e] + added) - B.values[e]);
    }
    check(MatSetValues(E_.get(), 1, &B.rows[k], static_cast<PetscInt>(row.size()),
                       &B.columns[B.start[k]], row.data(), INSERT_VALUES));
  }
  check(VecRestoreArrayRead(local, &mask));
  check(VecGhostRestoreLocalForm(mask_.get(), &local));
  check(MatAssemblyBegin(E_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(E_.get(), MAT_FINAL_ASSEMBLY));
}

void SharedHierarchy::truncate(const std::vector<char>& fixed,
                               const std::vector<TangentialStiffness>& W, const Vector& springs) {
  const Timed timed(Phase::faces);
  set_mask(fixed);
  fill_contact_part(W, springs);
  truncate_fine();
  truncate_coarse();
  if (!settled_) settle(cycle_.get(), level_);
  settled_ = true;
}

void SharedHierarchy::truncate_fine() {
  const Level& fine = level_.front();
  Mat A = fine.truncated.get();
  check(MatCopy(fine.A.get(), A, SAME_NONZERO_PATTERN));
  check(MatAXPY(A, 1, E_.get(), SUBSET_NONZERO_PATTERN));
  fill_empty_rows(fine);
}

void SharedHierarchy::truncate_coarse() {
  for (Index l = 1; l < levels(); ++l) {
    Level& level = level_[l];
    Mat change = l == 1 ? E_.get() : level_[l - 1].change.get();
    const MatReuse reuse = level.change.get() ? MAT_REUSE_MATRIX : MAT_INITIAL_MATRIX;
    check(MatPtAP(change, level_[l - 1].P.get(), reuse, PETSC_DEFAULT, level.change.fill()));
    check(MatCopy(level.A.get(), level.truncated.get(), SAME_NONZERO_PATTERN));
    check(MatAXPY(level.truncated.get(), 1, level.change.get(), SUBSET_NONZERO_PATTERN));
    fill_empty_rows(level);
  }
}

/// Rows of which the faces have left nothing get the diagonal they had, or 1.
void SharedHierarchy::fill_empty_rows(const Level& level) {
  VecHandle now;
  PetscInt first, end;
  const Real *before, *after;
  check(VecDuplicate(level.diagonal.get(), now.fill()));
  check(MatGetDiagonal(level.truncated.get(), now.get()));
  check(VecGetOwnershipRange(now.get(), &first, &end));
  check(VecGetArrayRead(level.diagonal.get(), &before));
  check(VecGetArrayRead(now.get(), &after));
  std::vector<std::pair<PetscInt, Real>> empty;
  for (PetscInt i = first; i < end; ++i)
    if (!(after[i - first] > vanished * before[i - first]))
      empty.emplace_back(i, before[i - first] > 0 ? before[i - first] : 1);
  check(VecRestoreArrayRead(level.diagonal.get(), &before));
  check(VecRestoreArrayRead(now.get(), &after));
  for (const auto& [i, value] : empty)
    check(MatSetValue(level.truncated.get(), i, i, value, INSERT_VALUES));
  check(MatAssemblyBegin(level.truncated.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(level.truncated.get(), MAT_FINAL_ASSEMBLY));
}

void SharedHierarchy::apply(const Vector& r, Vector& z) {
  const Timed timed(Phase::cycle);
  const Eigen::Index interior = r.size() - Eigen::Index(fixed_.size());
  free_ = r;
  for (std::size_t c = 0; c < fixed_.size(); ++c)
    if (fixed_[c]) free_[interior + Eigen::Index(c)] = 0;
  A_->to_slots(free_, r_.get());
  check(PCApply(cycle_.get(), r_.get(), z_.get()));
  A_->from_slots(z_.get(), z);
  for (std::size_t c = 0; c < fixed_.size(); ++c)
    if (fixed_[c]) z[interior + Eigen::Index(c)] = 0;
}

Real SharedHierarchy::operator_complexity() const {
  Real fine = 0, all = 0;
  for (const Level& level : level_) {
    MatInfo info;
    check(MatGetInfo(level.A.get(), MAT_GLOBAL_SUM, &info));
    all += info.nz_used;
    if (fine == 0) fine = info.nz_used;
  }
  return all / fine;
}

double SharedHierarchy::bytes() const {
  double all = 0;
  for (const Level& level : level_)
    for (Mat A : {level.A.get(), level.truncated.get(), level.P.get(), level.change.get()}) {
      if (!A) continue;
      MatInfo info;
      check(MatGetInfo(A, MAT_GLOBAL_SUM, &info));
      all += info.memory;
    }
  return all;
}

}  // namespace frictioncg
