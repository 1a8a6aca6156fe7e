#pragma once
#include "model/system.h"
#include "numbering.h"
#include "petsc.h"

namespace frictioncg {

/// The entries of A in rows or columns of contact dofs, in the rows of this process: what changes
/// with the faces.
struct ContactEntries {
  std::vector<PetscInt> rows;          ///< slots
  std::vector<std::size_t> start;      ///< rows + 1
  std::vector<PetscInt> columns;       ///< slots
  std::vector<Real> values;            ///< [force/length]
  std::vector<PetscInt> contact_slot;  ///< of each own contact dof
};

/// A of all processes as a matrix of PETSc's, and their common sums.
class SharedMatrix final : public Processes {
 public:
  /// Collective. local: the overlapping system of this process, its own rows complete.
  SharedMatrix(std::shared_ptr<const Domain> domain, Numbering numbering, const LocalSystem& local);

  void multiply(const Vector& x, Vector& Ax) const override;
  Vector magnitude(const Vector& x) const override;
  void sum(Real* values, Index count) const override { domain_->sum(values, count); }
  Real largest(Real value) const override { return domain_->largest(value); }
  Vector gathered(const Vector& own) const override { return domain_->gathered(own); }
  Vector combined(const Vector& own, const Both& both) const override {
    return domain_->combined(own, both);
  }
  Bodies bodies() const override { return bodies_; }

  const Domain& domain() const { return *domain_; }
  const Numbering& numbering() const { return numbering_; }
  Mat matrix() const { return A_.get(); }
  const ContactEntries& contact() const { return contact_; }

  /// Own dofs into the slots of a vector, and back.
  void to_slots(const Vector& x, Vec slots) const;
  void from_slots(Vec slots, Vector& x) const;
  /// The values of own dofs in a vector over the local ones.
  Vector own_part(const Vector& local) const;
  /// Own values over the local dofs, those of ghosts by their owners.   Collective.
  Vector on_local(const Vector& own) const;

 private:
  void assemble(const System& local);
  void find_contact(const System& local);
  void find_bodies(const LocalSystem& local);

  std::shared_ptr<const Domain> domain_;
  Numbering numbering_;
  MatHandle A_;
  VecHandle x_, Ax_;
  ContactEntries contact_;
  Bodies bodies_;
};

}  // namespace frictioncg
