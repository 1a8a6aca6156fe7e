#pragma once
#include "assembly/basis.h"
#include "assembly/dirichlet.h"
#include "whole_interface.h"

namespace frictioncg {

/// A mortar's change of basis, component by component, over the nodes of the whole interface.
struct InterfaceBasis {
  std::vector<Matrix> T, W;
};
InterfaceBasis basis_of(const WholeInterface& interface, const mortar::Mortar& mortar);

/// Of a matrix over the interface, by the numbers of its dofs.
struct NumberedEntry {
  NodeNumbers::Number i, j;
  Real a;
};

/// The part of a process, grown across the contact by guests: nodes of others that the rows of T'AT
/// of its own dofs are made of. Row p of T'AT is the sum of T_ip A_ij T_jq: owners send the rows
/// A_i of interface dofs to the owners of all p with T_ip != 0, and the columns of these rows, and
/// of the rows of T at all columns j of rows that are here, become guests.
///
/// Rows of A and of T that no own row of T'AT needs are not whole here.
class GrownPart {
 public:
  /// A: of the part; addend: symmetric, whole, the same on all processes, 0 where Dirichlet
  /// conditions hold; numbers get the guests.   Collective.
  GrownPart(const Domain& part, const Triplets& A, const Dirichlet& of_A,
            const WholeInterface& interface, const InterfaceBasis& basis,
            const std::vector<NumberedEntry>& addend, NodeNumbers& numbers);
  /// Of all dofs, as long as this lives: A, with the addend or without.
  Triplets matrix(bool with_addend) const;
  bool has_addend;
  /// Adds the addend's product with u to the own rows of f.
  void multiply_addend(const Vector& u, Vector& f) const;

  std::shared_ptr<const Domain> domain;
  std::vector<char> held;  ///< by Dirichlet conditions
  std::unique_ptr<const Dirichlet> dirichlet;
  Coupling coupling;

 private:
  friend struct Growth;
  void put(Index i, Index j, Real a);

  std::vector<Index> i_, j_;
  std::vector<Real> a_;
  std::size_t plain_ = 0;  ///< entries of A; those of the addend follow
};

}  // namespace frictioncg
