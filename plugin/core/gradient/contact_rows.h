#pragma once
#include "gradient/preconditioner.h"
#include "model/contact_problem.h"

namespace frictioncg {

/// The residual F - Ax on the contact dofs, kept while x moves.
///
/// Moves of contact dofs alone (a release, a node brought to rest) cost A_CC; the preconditioner,
/// which keeps the interior part of the residual, learns of them together: half a pass over A.
/// Vectors over the contact dofs are of size contact_dofs(); c counts them from 0.
class ContactRows {
 public:
  explicit ContactRows(const ContactProblem& problem);

  /// From r = F - Ax (n).
  void start(const Vector& r) { r_ = r.tail(r_.size()); }

  /// x has moved by rho v (n): r_C -= rho (Av)_C.
  void advance(Real rho, const Vector& v);

  /// x_C += dx at one contact dof; settle has to follow.
  void displace(Vector& x, Index c, Real dx);

  /// The interior is to learn that one contact dof has moved by dx, which r_C knows already.
  void owe(Index c, Real dx);

  /// Tells the interior of the displacements since the last call; set_contact has to follow.
  void settle(Preconditioner& P);

  /// (A v)_c of v (n), at one contact dof.
  Real row_product(Index c, const Vector& v) const;

  /// <A_CC d, d>, of d (contact_dofs()).
  Real energy(const Vector& d) const;

  const Vector& r() const { return r_; }

 private:
  const System& system_;
  Vector r_;                ///< F - Ax, without friction
  Vector dx_C_;             ///< displacements that the interior has not seen
  bool displaced_ = false;  ///< there are some
};

/// Per node (m), the largest eigenvalue of A_TT [force/length]; 0 where there are no tangents.
Vector tangential_stiffness(const System& system);

}  // namespace frictioncg
