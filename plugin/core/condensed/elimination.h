#pragma once
#include "condensed/condensed_problem.h"

namespace frictioncg {

/// CPU seconds of each phase.
struct EliminationTimes {
  double order = 0, factor = 0, condense = 0;
};

/// Elimination of the interior of one system:  S x_C = f - r_C  on the contact dofs.
///   S = A_CC - A_CI A_II^{-1} A_IC,  f = F_C - A_CI A_II^{-1} F_I
///
/// Where A_II is singular, some rigid motions leave every contact dof where it is (a body on a
/// frictionless plane may float along it): contact never sees them, S and f exist all the same, and
/// they are named.
class Elimination {
 public:
  enum class Outcome { done, not_positive_definite, too_large };

  virtual ~Elimination() = default;

  /// memory_bound [bytes] is for the factor and the dense matrices on the contact dofs. again: the
  /// system has the pattern of the last one, whose ordering and layout stay.
  virtual Outcome factor(const System& system, double memory_bound, bool again = false) = 0;

  /// What factor needs at least, as far as it is known before anything is factored [bytes].
  virtual double memory_needed() const = 0;

  virtual const DenseMatrix& S() const = 0;  ///< contact_dofs square, symmetric

  virtual Vector condense(const Vector& F) = 0;  ///< f (contact_dofs) from F (n)

  /// x (n) from x_C, for the load of the last condense: A_II x_I = F_I - A_IC x_C.
  virtual Vector recover(const Vector& x_C) = 0;

  /// The same without a load: the motion of the body that moves the contact dofs by w_C.
  virtual Vector extend(const Vector& w_C) = 0;

  /// n x k: rigid motions of A that vanish on the contact dofs.
  virtual const DenseMatrix& floating() const = 0;

  virtual const EliminationTimes& times() const = 0;
};

}  // namespace frictioncg
