#pragma once
#include "model/system.h"
#include "numbering.h"
#include "petsc.h"

namespace frictioncg {

/// Rows of this process, in PETSc's numbering of columns.
struct Rows {
  std::vector<PetscInt> start{0}, columns;
  std::vector<Real> values;

  void end_row() { start.push_back(static_cast<PetscInt>(columns.size())); }
};

/// A of all processes as a matrix of PETSc's, and what this process owns of the system.
class SharedMatrix final : public System {
 public:
  /// Collective. local: the overlapping system of this process, its own rows complete.
  SharedMatrix(std::shared_ptr<const Domain> domain, Numbering numbering, const LocalSystem& local);

  void multiply(const Vector& x, Vector& Ax) const override;
  Vector multiply_sized(const Vector& x, Vector& Ax) const override;
  void move_contact(const Vector& dx_C, Vector& r) const override;
  Bodies bodies() const override { return bodies_; }
  const Matrix& entries() const override;
  void sum(Real* values, Index count) const override { domain_->sum(values, count); }
  Real largest(Real value) const override { return domain_->largest(value); }
  Vector gathered(const Vector& own) const override { return domain_->gathered(own); }
  Vector combined(const Vector& own, const Both& both) const override {
    return domain_->combined(own, both);
  }

  const Domain& domain() const { return *domain_; }
  const Numbering& numbering() const { return numbering_; }
  Mat matrix() const { return A_.get(); }
  /// The entries of A in rows or columns of contact dofs, and 0 elsewhere in the blocks of contact
  /// nodes: what changes with the faces.
  Mat contact() const { return B_.get(); }

  /// Own dofs into the slots of a vector, and back.
  void to_slots(const Vector& x, Vec slots) const;
  void from_slots(Vec slots, Vector& x) const;
  /// The values of own dofs in a vector over the local ones.
  Vector own_part(const Vector& local) const { return local(numbering_.own); }
  /// Own values over the local dofs, those of ghosts by their owners.   Collective.
  Vector on_local(const Vector& own) const;

 private:
  void assemble();
  void find_contact();
  MatHandle matrix_of(const Rows& rows) const;

  std::shared_ptr<const Domain> domain_;
  Numbering numbering_;
  SystemPtr local_;
  MatHandle A_, B_;
  VecHandle x_, Ax_, on_local_;
  ScatterHandle to_local_;  ///< of slots to all local dofs
  Bodies bodies_;
};

}  // namespace frictioncg
