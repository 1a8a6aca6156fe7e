#pragma once
#include "model/proximal_springs.h"
#include "multigrid/conjugate_residuals.h"
#include "multigrid/faces.h"
#include "solution.h"

namespace frictioncg {

/// Inexact semismooth Newton on the unregularized laws: the linear system of the present faces,
/// solved until its residual falls below a share Gamma of what the faces violate; then all faces
/// are chosen anew.
class InexactNewton {
 public:
  /// affordable: the cycles that another method of the caller costs, or infinity. Ends, stagnated,
  /// where the rate of a linear system promises more, where the forces of the first one violate the
  /// laws by more than most_violation times the load, or where faces leave a motion free.
  /// answer: gets x, what it took, and, where it has converged, the certificate; of the steps
  /// newton is the first cycle after an update of the faces, conjugate are the others.
  InexactNewton(const ContactProblem& problem, Hierarchy& hierarchy, Observer* observer,
                Real affordable, Real most_violation, Solution& answer);

  /// From x0 (n), where b0 = F - A x0 (n) is known, or where it is empty from 0; on the given
  /// branches, or where these are empty on those of x0, or where that is, too, on those that
  /// nothing but the gaps tells. Friction is to follow the slip to about tol, too, where rounding
  /// allows it. converged: by the certificate; max_iterations; stagnated: neither further updates
  /// of the faces nor springs reduce the violation.
  Status solve(Real tol, Index max_iterations, const Vector& x0, const Vector& b0,
               const Branches& start = {});

  const Branches& faces() const { return faces_.all(); }

 private:
  void move_onto_faces();
  bool solve_faces();
  bool costs_too_much(Real from, Index cycles) const;
  bool violation_falls(Real violation);
  Real spring_force() const;
  void attach_springs();
  bool release_springs();
  bool retreat(bool solved);
  bool accept(Certificate certificate, Real tol, bool held);
  Status ended(Status otherwise);

  const ContactProblem& problem_;
  const System& system_;
  Hierarchy& hierarchy_;
  Observer* const observer_;
  const Real affordable_;      ///< cycles
  const Real most_violation_;  ///< over the load
  Faces faces_;
  ConjugateResiduals inner_;
  Solution& answer_;
  Vector b_;         ///< n, F - Ax, and the springs' force
  Vector b_C_, s_;   ///< contact dofs of b; n, residual of the linear system
  Vector accepted_;  ///< n, the last x that the certificate lets pass; or empty
  Real goal_ = 0;    ///< of residual and violation [norm_D]
  Real load_ = 0;    ///< norm_D of the load, or of what gaps press with, if more
  Index max_iterations_ = 0;
  bool gave_up_ = false;
  /// Violations (norm_D) since the springs were set: after the first update, the least one, and the
  /// updates since then.
  Real first_violation_ = infinity, least_violation_ = infinity;
  int updates_since_least_ = 0;

  ProximalSprings proximal_;
  Vector springs_;  ///< contact_dofs [force/length]; 0 until faces have left a motion free
  Vector rest_;     ///< n, x where they are at rest
  Branches faces_at_rest_;
  bool sprung_ = false, judged_ = false;
  int retreats_ = 0, soft_releases_ = 0;
};

}  // namespace frictioncg
