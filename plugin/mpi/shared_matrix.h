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

/// A of all processes as a matrix of PETSc's.
class SharedMatrix {
 public:
  /// Collective. local: the overlapping system of this process, its own rows complete.
  SharedMatrix(std::shared_ptr<const Domain> domain, Numbering numbering, const LocalSystem& local);

  void multiply(const Vector& x, Vector& Ax) const;  ///< own rows of A x
  Vector magnitude(const Vector& x) const;           ///< own rows of |A||x|
  const Bodies& bodies() const { return bodies_; }   ///< in the graph of A

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

/// What this process owns of a system that several share.
struct SharedSystem final : System {
  std::shared_ptr<const SharedMatrix> A;

  void multiply(const Vector& x, Vector& Ax) const override { A->multiply(x, Ax); }
  Vector multiply_sized(const Vector& x, Vector& Ax) const override;
  void move_contact(const Vector& dx_C, Vector& r) const override;
  Bodies bodies() const override { return A->bodies(); }
  const Matrix& entries() const override;
  void sum(Real* values, Index count) const override { A->domain().sum(values, count); }
  Real largest(Real value) const override { return A->domain().largest(value); }
  Vector gathered(const Vector& own) const override { return A->domain().gathered(own); }
  Vector combined(const Vector& own, const Both& both) const override {
    return A->domain().combined(own, both);
  }
};

}  // namespace frictioncg
