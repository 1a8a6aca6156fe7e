#pragma once
#include "settings.h"
#include "model/contact_problem.h"

namespace frictioncg {

/// A contact problem on the contact dofs alone, after elimination of the interior:
///   r = f - (S + springs D) x, laws of contact and friction on (x, r) node by node.
struct CondensedProblem {
  const DenseMatrix& S;          ///< contact_dofs square
  Vector f;                      ///< contact_dofs [force]
  Vector D;                      ///< contact_dofs, > 0, System::weight: the unit of residuals
  const ContactProblem& laws;    ///< gap, mu or g, and the layout of the nodes
  Real springs = 0;              ///< to the ground, on every contact dof, in units of D
  Observer* observer = nullptr;  ///< hears of every step of the layers

  Index normal(Index i) const { return laws.system->first[i] - laws.interior(); }

  /// f - (S + springs D) x
  Vector residual(const Vector& x) const;

  /// The same without springs in the form that the paper's methods take: all dofs are contact dofs.
  /// S in sparse form takes half as much again as S.
  ContactProblem on_contact_dofs() const;
};

}  // namespace frictioncg
