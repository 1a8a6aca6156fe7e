#include "shared_matrix.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "parts.h"

namespace frictioncg {

SharedMatrix::SharedMatrix(std::shared_ptr<const Domain> domain, Numbering numbering,
                           const LocalSystem& local)
    : domain_(std::move(domain)), numbering_(std::move(numbering)) {
  assemble(*local.system());
  find_contact(*local.system());
  find_bodies(local);
  check(MatCreateVecs(A_.get(), x_.fill(), Ax_.fill()));
  check(VecSet(x_.get(), 0));
}

namespace {

/// Rows of whole blocks in PETSc's numbering.
struct BlockRows {
  std::vector<PetscInt> start{0}, columns;
  std::vector<Real> values;
};

/// The rows of one node, with all slots of each node that any of them touches: aggregation counts
/// on whole blocks. Empty slots get `filler` on their diagonal.
void add_node(const Numbering& numbering, const System& local, const std::vector<Index>& dofs,
              PetscInt first_slot, BlockRows& rows) {
  const Index d = numbering.dimension;
  std::vector<PetscInt> touched{first_slot / d};
  for (Index p : dofs)
    for (Matrix::InnerIterator e(local.entries(), p); e; ++e)
      touched.push_back(numbering.slot[e.col()] / d);
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
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
    rows.start.push_back(static_cast<PetscInt>(rows.columns.size()));
  }
}

}  // namespace

void SharedMatrix::assemble(const System& local) {
  BlockRows rows;
  for (Index k = 0; k < numbering_.nodes; ++k)
    add_node(numbering_, local, numbering_.at[k], numbering_.first + k * numbering_.dimension,
             rows);
  const PetscInt n = numbering_.slots();
  check(MatCreate(domain_->communicator(), A_.fill()));
  check(MatSetSizes(A_.get(), n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetBlockSize(A_.get(), numbering_.dimension));
  check(MatSetType(A_.get(), MATAIJ));
  check(MatSeqAIJSetPreallocationCSR(A_.get(), rows.start.data(), rows.columns.data(),
                                     rows.values.data()));
  check(MatMPIAIJSetPreallocationCSR(A_.get(), rows.start.data(), rows.columns.data(),
                                     rows.values.data()));
  check(MatSetOption(A_.get(), MAT_SYMMETRIC, PETSC_TRUE));
  check(MatSetOption(A_.get(), MAT_SPD, PETSC_TRUE));
}

/// The blocks of contact nodes are stored whole: laws add to them where A has zeros.
void SharedMatrix::find_contact(const System& local) {
  const Numbering& N = numbering_;
  std::vector<Index> node_of(local.contact_dofs());
  for (Index i = 0; i < local.nodes(); ++i)
    for (Index p = local.first[i]; p < local.first[i + 1]; ++p) node_of[p - local.interior()] = i;
  contact_.start.push_back(0);
  std::map<PetscInt, Real> row;
  for (Index p : N.own) {
    const bool contact = p >= local.interior();
    row.clear();
    for (Matrix::InnerIterator e(local.entries(), p); e; ++e)
      if (contact || e.col() >= local.interior()) row[N.slot[e.col()]] = e.value();
    if (contact) {
      const Index i = node_of[p - local.interior()];
      for (Index q = local.first[i]; q < local.first[i + 1]; ++q) row.emplace(N.slot[q], 0);
      contact_.contact_slot.push_back(N.slot[p]);
    }
    if (row.empty()) continue;
    contact_.rows.push_back(N.slot[p]);
    for (const auto& [column, value] : row) {
      contact_.columns.push_back(column);
      contact_.values.push_back(value);
    }
    contact_.start.push_back(contact_.columns.size());
  }
}

void SharedMatrix::find_bodies(const LocalSystem& local) {
  const Bodies parts = bodies_of(local.system()->entries());
  const std::vector<Index>& origin = local.basis().origin;
  std::vector<DofOfPart> dofs;
  for (std::size_t p = 0; p < origin.size(); ++p) dofs.push_back({origin[p], parts.of[p]});
  const Wholes wholes = join_parts(*domain_, dofs, parts.count);
  for (Index p : numbering_.own) bodies_.of.push_back(wholes.of_part[parts.of[p]]);
  bodies_.count = wholes.count;
}

void SharedMatrix::to_slots(const Vector& x, Vec slots) const {
  Real* values;
  check(VecGetArray(slots, &values));
  for (std::size_t k = 0; k < numbering_.own.size(); ++k)
    values[numbering_.slot[numbering_.own[k]] - numbering_.first] = x[static_cast<Index>(k)];
  check(VecRestoreArray(slots, &values));
}

void SharedMatrix::from_slots(Vec slots, Vector& x) const {
  const Real* values;
  x.resize(static_cast<Index>(numbering_.own.size()));
  check(VecGetArrayRead(slots, &values));
  for (std::size_t k = 0; k < numbering_.own.size(); ++k)
    x[static_cast<Index>(k)] = values[numbering_.slot[numbering_.own[k]] - numbering_.first];
  check(VecRestoreArrayRead(slots, &values));
}

Vector SharedMatrix::own_part(const Vector& local) const {
  Vector own(static_cast<Index>(numbering_.own.size()));
  for (Index k = 0; k < own.size(); ++k) own[k] = local[numbering_.own[k]];
  return own;
}

Vector SharedMatrix::on_local(const Vector& own) const {
  Vector local = Vector::Zero(static_cast<Index>(numbering_.slot.size()));
  for (Index k = 0; k < own.size(); ++k) local[numbering_.own[k]] = own[k];
  numbering_.update(*domain_, local);
  return local;
}

void SharedMatrix::multiply(const Vector& x, Vector& Ax) const {
  const Timed timed(Phase::product);
  to_slots(x, x_.get());
  check(MatMult(A_.get(), x_.get(), Ax_.get()));
  from_slots(Ax_.get(), Ax);
}

/// A is not kept twice: its entries lose their signs for one product.
Vector SharedMatrix::magnitude(const Vector& x) const {
  MatHandle sizes;
  check(MatDuplicate(A_.get(), MAT_COPY_VALUES, sizes.fill()));
  Mat blocks[] = {sizes.get(), nullptr};
  PetscBool parallel;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(sizes.get()), MATMPIAIJ, &parallel));
  if (parallel) check(MatMPIAIJGetSeqAIJ(sizes.get(), &blocks[0], &blocks[1], nullptr));
  for (Mat block : blocks) {
    if (!block) continue;
    MatInfo info;
    Real* values;
    check(MatGetInfo(block, MAT_LOCAL, &info));
    check(MatSeqAIJGetArray(block, &values));
    for (PetscInt k = 0; k < static_cast<PetscInt>(info.nz_used); ++k)
      values[k] = std::abs(values[k]);
    check(MatSeqAIJRestoreArray(block, &values));
  }
  to_slots(x.cwiseAbs(), x_.get());
  check(MatMult(sizes.get(), x_.get(), Ax_.get()));
  Vector result;
  from_slots(Ax_.get(), result);
  return result;
}

Vector SharedSystem::multiply_sized(const Vector& x, Vector& Ax) const {
  A->multiply(x, Ax);
  return A->magnitude(x);
}

void SharedSystem::move_contact(const Vector& dx_C, Vector& r) const {
  Vector dx = Vector::Zero(dofs()), Adx;
  dx.tail(dx_C.size()) = dx_C;
  multiply(dx, Adx);
  r -= Adx;
}

const Matrix& SharedSystem::entries() const {
  throw std::logic_error("the entries of A are shared by processes");
}

}  // namespace frictioncg
