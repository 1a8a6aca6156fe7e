#pragma once
#include "gradient/release_rule.h"

namespace frictioncg {

/// GCX: contact and stick are both faces, and no 1/eps enters the matrix. An active-set method with
/// proportioning, after Dostal's MPRGP, that minimizes J of (5) itself:
///
///   repeat
///     while |r_free| > |beta|       r_free: residual on the free dofs of the present face
///       one step of the conjugate gradient on the face; a node that reaches its gap joins the
///       contact face, and the step goes on along the direction bent there, while J falls
///       a node that turned round goes to the minimum of J over its x_T; at 0, it joins the stick
///       face
///     release:  d = W^{-1} beta,  rho = <beta, d>/<A d, d>,  x += rho d,  new face, restart
///   until |r_free|^2 + |beta|^2 <= eps_0^2
///
/// beta is what the faces violate: r_N where it is tensile, r_T (1 - g/|r_T|) where it exceeds the
/// limit. Along d each released node leaves its face straight into the feasible side, where J is
/// the parabola J - rho <beta, d> + rho^2/2 <A d, d>: the step is its minimum. d lives on the
/// contact dofs, so that the step costs A_CC, and half a pass for the interior.
///
/// Why it ends: J never rises. A release lowers it by at least c |beta|^2, c > 0 fixed by A alone,
/// so |beta| at the releases tends to 0, and |r_free| <= |beta| with it: infinitely many releases
/// would meet eps_0. After the last of them the faces only grow, at most 2m times. From there on it
/// is a conjugate gradient on one face, which brings r_free below any bound: it cannot come to a
/// stand at a kink x_T = 0 that is no minimum over x_T, because turning round there lowers J by an
/// amount that the distance from the kink does not change.
class Gcx final : public ReleaseRule {
 public:
  explicit Gcx(const System& system) : d_(Vector::Zero(system.contact_dofs())) {}
  Real threshold(Real, Real violation) const override { return proportion * violation; }
  bool release(Iterate& it, Real least) override;
  bool expands() const override { return true; }
  bool stick_is_a_face() const override { return true; }

 private:
  Real descent(const Iterate& it, Real least);

  /// Gamma of MPRGP: the face is left where it has less to give than its release. 1 is Dostal's.
  static constexpr Real proportion = 1;
  Vector d_;  ///< contact_dofs()
};

}  // namespace frictioncg
