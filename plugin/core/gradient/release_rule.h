#pragma once
#include "gradient/iterate.h"

namespace frictioncg {

/// When, and how, the nodes are let go whose face violates the laws: contact under tension, stick
/// beyond the sliding limit. This table is all that tells the methods apart (section 3):
///
///         nodes are let go                    then        stick     a step that meets a gap
///   GC1   at each iteration                   restart     phi_eps   ends there
///   GC2   at each iteration                   conjugate   phi_eps   ends there
///   GC3   at |r_free| <= eps_1                restart     phi_eps   ends there
///   GCX   at |r_free| <= |beta|, by a step    restart     a face    goes on, bent
///
/// GC1 is by Jeusette and Sonzogni, GC2 by Dilintas, GC3 the paper's own, with eps_1 = partial
/// eps_0.
///
/// GCX is an active-set method with proportioning, after Dostal's MPRGP, that minimizes J of (5)
/// itself; no 1/eps enters its matrix. beta is what the faces violate: r_N where it is tensile,
/// r_T (1 - g/|r_T|) where it exceeds the limit. A release is a step
///   d = W^{-1} beta,  rho = <beta, d>/<A d, d>,  x += rho d.
/// Along d each released node leaves its face straight into the feasible side, where J is the
/// parabola J - rho <beta, d> + rho^2/2 <A d, d>: the step goes to its minimum. d lives on the
/// contact dofs, so that the step costs A_CC, and half a pass for the interior.
///
/// Why GCX ends: J never rises. A release lowers it by at least c |beta|^2, c > 0 fixed by A alone,
/// so |beta| at the releases tends to 0, and |r_free| <= |beta| with it: infinitely many releases
/// would meet eps_0. After the last of them the faces only grow, at most 2m times. From there on it
/// is a conjugate gradient on one face, which brings r_free below any bound: it cannot come to a
/// stand at a kink x_T = 0 that is no minimum over x_T, because turning round there lowers J by an
/// amount that the distance from the kink does not change.
class ReleaseRule {
 public:
  ReleaseRule(const Settings& settings, const System& system);

  /// Nodes are let go at each iteration, before anything is measured.
  bool at_once() const { return at_once_; }
  /// A release is followed by v = P r, in place of conjugating.
  bool restarts() const { return restarts_; }
  /// Stick is a face, as contact is, in place of a regularized |x_T|; and a step that ends at a gap
  /// goes on along the direction bent there, while J falls.
  bool stick_is_a_face() const { return stick_is_a_face_; }

  /// The norm of the residual on the free dofs down to which the faces are kept, given the final
  /// one, eps_0, and the violation (all in norm_D).
  Real threshold(Real eps_0, Real violation) const;

  /// Lets go of the nodes that violate by more than `least` (norm_D). True if there is one; where x
  /// has moved, only on the contact dofs, through it.rows.
  bool release(Iterate& it, Real least);

 private:
  bool release_by_step(Iterate& it, Real least);
  Real descent(const Iterate& it, Real least);

  const bool at_once_, restarts_, stick_is_a_face_;
  const Real partial_;  ///< GC3: eps_1/eps_0, the paper's 100
  Vector d_;            ///< GCX: contact_dofs
};

/// Where stick is a face: what becomes of the nodes that a step rho v has turned round, and of
/// those that move no more than the residual explains. One after the other, while all others stay,
/// each goes to the minimum over its x_T of
///   J with A_TT replaced by stiffness I >= A_TT:   x_T := (1 - g/|y|)_+ y/stiffness,
///                                                  y = (F - Ax)_T + stiffness x_T,
/// so that J never rises. A node whose minimum is x_T = 0 is held there from here on; one that only
/// creeps stays where its minimum is elsewhere. True if a node has moved.
/// stiffness (m): of A_TT; residual: of the free dofs, in norm_D, roughly.
bool come_to_rest(Iterate& it, const Vector& v, Real rho, const Vector& stiffness, Real residual);

}  // namespace frictioncg
