#pragma once
#include "gradient/preconditioner.h"
#include "gradient/regularization.h"
#include "gradient/tresca.h"
#include "model/contact_problem.h"

namespace frictioncg {

/// (A v)_i, at one dof, of v (n).
inline Real row_product(const System& system, Index i, const Vector& v_in) {
  const auto [row, col, a] = arrays_of(system.entries());
  const Real* v = v_in.data();
  Real sum = 0;
  for (Index k = row[i]; k < row[i + 1]; ++k) sum += a[k] * v[col[k]];
  return sum;
}

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

/// The faces that x lies on: nodes held at their gap (section 3), and, where stick is a face, nodes
/// held at x_T = 0. Joining a face never moves x, but by rounding.
///
/// Vectors over the nodes have m entries; r_C is F - Ax on the contact dofs.
class ActiveSet {
 public:
  explicit ActiveSet(const ContactProblem& problem);

  /// Puts x (n) on x_N <= gap, and on x_T = 0 where the tangents are stuck; what touches, is held.
  void start(Vector& x, const Vector& g, Tangents tangents, bool stick_is_a_face);

  bool contact(Index i) const { return contact_[i]; }
  /// x_T of node i is fixed at 0, by its face or by Tangents::stuck.
  bool at_rest(Index i) const { return stuck_ || stick_[i]; }

  void activate_stick(Index i) { stick_[i] = 1; }
  void open_contact(Index i) { contact_[i] = 0; }
  void open_stick(Index i) { stick_[i] = 0; }

  /// Smallest rho at which a free contact node reaches its gap along x + rho v; infinite if none.
  Real step_to_gap(const Vector& x, const Vector& v) const;

  /// Holds the nodes that x, moved by rho v, has brought to their gap. True if there is one.
  bool close_gaps(Vector& x, const Vector& v, Real rho);

  /// Holds again the open nodes at their gap that v would drive into the obstacle.
  bool activate_blocked(const Vector& x, const Vector& v);

  /// Opens the nodes on which the obstacle would have to pull by more than the threshold (norm_D).
  bool open_tensile(const Vector& r_C, Real threshold);

  /// Tension at node i, and force beyond its limit at a stick face: what they violate, >= 0
  /// [force].
  Real tension(Index i, const Vector& r_C) const;
  Real stick_excess(Index i, const Vector& r_C, const Vector& g) const;

  /// Norm (norm_D) of what the faces violate.
  Real violation(const Vector& r_C, const Vector& g) const;

 private:
  const ContactProblem& problem_;
  const System& system_;
  std::vector<char> contact_, stick_;
  bool stuck_ = false;
};

/// Where a minimization stands.
struct Iterate {
  explicit Iterate(const ContactProblem& problem);

  /// Makes r and part, after x, rows or faces have changed. True where a node has come to another
  /// piece of a piecewise quadratic J: across eps, or, with eps = 0, across x_T = 0 along a single
  /// tangent.
  bool update_friction();
  /// <g phi'(x_T), v>: what <F - Ax, v> has more than <-J', v>; v is 0 on held dofs.
  Real friction_along(const Vector& v) const { return (rows.r() - r).dot(v.tail(r.size())); }

  const System& system;
  Vector x;          ///< n
  Vector g;          ///< m, the sliding limit
  Phi phi;           ///< that J_eps has
  ContactRows rows;  ///< F - Ax on the contact dofs
  ActiveSet faces;   ///< that x lies on
  Vector r;          ///< -J' of (11), contact_dofs(): that of rows less g phi'(x_T), 0 where held
  ContactPart part;  ///< what is free, and g phi'' of (17)

 private:
  std::vector<char> piece_;  ///< m, which one x_T was on
};

}  // namespace frictioncg
