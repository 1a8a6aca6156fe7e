#include "shared_matrix.h"

namespace frictioncg {

SharedMatrix::SharedMatrix(std::shared_ptr<const Domain> domain, Numbering numbering,
                           const LocalSystem& local)
    : domain_(std::move(domain)), numbering_(std::move(numbering)), local_(local.system()) {
  dimension = local_->dimension;
  D = own_part(local_->D);
  weight = own_part(local_->weight);
  first = numbering_.own_first;
  assemble();
  find_contact();
  const Bodies wholes = join_parts(*domain_, local.basis().origin, bodies_of(local_->entries()));
  for (Index p : numbering_.own) bodies_.of.push_back(wholes.of[p]);
  bodies_.count = wholes.count;
  check(MatCreateVecs(A_.get(), x_.fill(), Ax_.fill()));
  check(VecSet(x_.get(), 0));
  const PetscInt n = static_cast<PetscInt>(numbering_.slot.size());
  IS slots;
  check(ISCreateGeneral(PETSC_COMM_SELF, n, numbering_.slot.data(), PETSC_USE_POINTER, &slots));
  check(VecCreateSeq(PETSC_COMM_SELF, n, on_local_.fill()));
  check(VecScatterCreate(x_.get(), slots, on_local_.get(), nullptr, to_local_.fill()));
  check(ISDestroy(&slots));
}

namespace {

/// The rows of one node, with all slots of each node that any of them touches: aggregation counts
/// on whole blocks. Empty slots get `filler` on their diagonal.
void add_node(const Numbering& numbering, const System& local, const std::vector<Index>& dofs,
              Rows& rows) {
  const Index d = numbering.dimension;
  const PetscInt first_slot = numbering.slot[dofs.front()];
  std::vector<PetscInt> touched{first_slot / d};
  for (Index p : dofs)
    for (Matrix::InnerIterator e(local.entries(), p); e; ++e)
      touched.push_back(numbering.slot[e.col()] / d);
  sort_once(touched);
  const Real filler = local.weight[dofs.front()];
  for (Index s = 0; s < d; ++s) {
    const std::size_t begin = rows.columns.size();
    for (PetscInt node : touched)
      for (Index c = 0; c < d; ++c) rows.columns.push_back(node * d + c);
    rows.values.resize(rows.columns.size(), 0);
    const auto at = [&](PetscInt slot) -> Real& {
      const auto node = std::lower_bound(touched.begin(), touched.end(), slot / d);
      return rows.values[begin + (node - touched.begin()) * d + slot % d];
    };
    if (s >= static_cast<Index>(dofs.size()))
      at(first_slot + s) = filler;
    else
      for (Matrix::InnerIterator e(local.entries(), dofs[s]); e; ++e)
        at(numbering.slot[e.col()]) += e.value();
    rows.end_row();
  }
}

}  // namespace

void SharedMatrix::assemble() {
  Rows rows;
  for (const std::vector<Index>& dofs : numbering_.at) add_node(numbering_, *local_, dofs, rows);
  A_ = matrix_of(rows);
  check(MatSetOption(A_.get(), MAT_SYMMETRIC, PETSC_TRUE));
  check(MatSetOption(A_.get(), MAT_SPD, PETSC_TRUE));
}

MatHandle SharedMatrix::matrix_of(const Rows& rows) const {
  const PetscInt n = numbering_.slots();
  MatHandle matrix;
  check(MatCreate(domain_->communicator(), matrix.fill()));
  Mat M = matrix.get();
  check(MatSetSizes(M, n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetBlockSize(M, numbering_.dimension));
  check(MatSetType(M, MATAIJ));
  check(
      MatSeqAIJSetPreallocationCSR(M, rows.start.data(), rows.columns.data(), rows.values.data()));
  check(
      MatMPIAIJSetPreallocationCSR(M, rows.start.data(), rows.columns.data(), rows.values.data()));
  return matrix;
}

/// The blocks of contact nodes are stored whole: laws add to them where A has zeros.
void SharedMatrix::find_contact() {
  const Numbering& N = numbering_;
  const System& local = *local_;
  Rows rows;
  std::map<PetscInt, Real> row;
  const auto fill = [&](Index p) {
    const bool contact = p >= local.interior();
    for (Matrix::InnerIterator e(local.entries(), p); e; ++e)
      if (contact || e.col() >= local.interior()) row[N.slot[e.col()]] = e.value();
    if (!contact) return;
    const auto end = std::upper_bound(local.first.begin(), local.first.end(), p);
    for (Index q = end[-1]; q < *end; ++q) row.emplace(N.slot[q], 0);
  };
  for (const std::vector<Index>& dofs : N.at)
    for (std::size_t s = 0; s < std::size_t(N.dimension); ++s) {
      row.clear();
      if (s < dofs.size()) fill(dofs[s]);
      for (const auto& [column, value] : row) {
        rows.columns.push_back(column);
        rows.values.push_back(value);
      }
      rows.end_row();
    }
  B_ = matrix_of(rows);
}

void SharedMatrix::to_slots(const Vector& x, Vec slots) const {
  Real* values;
  check(VecGetArray(slots, &values));
  Eigen::Map<Vector>(values, numbering_.slots())(numbering_.own_slot) = x;
  check(VecRestoreArray(slots, &values));
}

void SharedMatrix::from_slots(Vec slots, Vector& x) const {
  const Real* values;
  check(VecGetArrayRead(slots, &values));
  x = Eigen::Map<const Vector>(values, numbering_.slots())(numbering_.own_slot);
  check(VecRestoreArrayRead(slots, &values));
}

Vector SharedMatrix::on_local(const Vector& own) const {
  Vec local = on_local_.get();
  const Real* values;
  to_slots(own, x_.get());
  check(VecScatterBegin(to_local_.get(), x_.get(), local, INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(to_local_.get(), x_.get(), local, INSERT_VALUES, SCATTER_FORWARD));
  check(VecGetArrayRead(local, &values));
  const Vector x = Eigen::Map<const Vector>(values, static_cast<Index>(numbering_.slot.size()));
  check(VecRestoreArrayRead(local, &values));
  return x;
}

void SharedMatrix::multiply(const Vector& x, Vector& Ax) const {
  const Timed timed(Phase::product);
  to_slots(x, x_.get());
  check(MatMult(A_.get(), x_.get(), Ax_.get()));
  from_slots(Ax_.get(), Ax);
}

Vector SharedMatrix::multiply_sized(const Vector& x, Vector& Ax) const {
  Vector all;
  const Vector sizes = local_->multiply_sized(on_local(x), all);
  Ax = own_part(all);
  return own_part(sizes);
}

void SharedMatrix::move_contact(const Vector& dx_C, Vector& r) const {
  Vector dx = Vector::Zero(dofs()), Adx;
  dx.tail(dx_C.size()) = dx_C;
  multiply(dx, Adx);
  r -= Adx;
}

const Matrix& SharedMatrix::entries() const {
  throw std::logic_error("the entries of A are shared by processes");
}

}  // namespace frictioncg
