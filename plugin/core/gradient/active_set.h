#pragma once
#include "gradient/tresca.h"
#include "model/contact_problem.h"

namespace frictioncg {

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

}  // namespace frictioncg
