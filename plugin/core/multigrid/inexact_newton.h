#pragma once
#include <limits>

#include "multigrid/conjugate_residuals.h"
#include "multigrid/faces.h"
#include "settings.h"

namespace frictioncg {

/// Inexact semismooth Newton on the unregularized laws: the linear system of the present faces,
/// solved until its residual falls below a share Gamma of what the faces violate; then all faces
/// are chosen anew.
class InexactNewton {
 public:
  InexactNewton(const ContactProblem& problem, Hierarchy& hierarchy, Observer* observer = nullptr);

  /// From the branches of x0 (n), or where it is empty from the given ones, or where these are,
  /// too, from stick. Friction is to follow the slip to about tol, too, where rounding allows it.
  /// converged: by the certificate; max_iterations; stagnated: neither a tighter
  /// Gamma nor a new start reduces the violation.
  Status solve(Real tol, Index max_iterations, const Vector& x0, const Branches& start = {});

  /// For a caller who has another method, which costs as much as so many cycles. Ends, stagnated,
  /// as soon as the residual of a linear system does not fall as it does by a good hierarchy, or so
  /// slowly that tol would take more than that, or what the faces violate grows, as it does in
  /// slender bodies.
  void give_up_early(Real affordable_cycles) {
    gives_up_early_ = true;
    affordable_ = affordable_cycles;
  }

  const Vector& x() const { return x_; }
  /// not_positive_definite: n, the direction.
  Vector negative() const { return inner_.indefinite() ? inner_.last() : Vector(); }
  const Branches& faces() const { return faces_.all(); }
  Index iterations() const { return iterations_; }  ///< cycles
  Index updates() const { return updates_; }        ///< of the faces
  /// newton: the first cycle after an update of the faces; conjugate: the others.
  const StepCounts& steps() const { return steps_; }

 private:
  void move_onto_faces();
  void recompute_forces();
  bool solve_faces();
  bool costs_too_much(Real from, Index cycles, Real violation) const;
  void count(StepLabel label);
  bool progress(bool solved, Real violation);
  Real spring_force() const;
  void set_springs(Real over_D);
  bool release_springs();
  bool retreat(bool solved);
  bool accept(Real tol, bool held);
  Status ended(Status otherwise);

  const ContactProblem& problem_;
  const System& system_;
  Hierarchy& hierarchy_;
  Observer* const observer_;
  Faces faces_;
  ConjugateResiduals inner_;
  Vector x_, b_;                           ///< n; b = F - Ax, and the springs' force
  Vector b_C_, s_;                         ///< contact dofs of b; n, residual of the linear system
  Real spring_ = 0, least_spring_ = 1e-8;  ///< over D
  Vector springs_;   ///< contact_dofs [force/length]: proximal, 0 until faces left a motion free
  Vector accepted_;  ///< n, the last x that the certificate lets pass; or empty
  Vector rest_;      ///< n, x where they are at rest
  Branches faces_at_rest_;
  Real last_force_ = 0;             ///< of the springs, when they were released last
  Real Gamma_ = 0.3;                ///< residual over violation at which faces are chosen anew
  Real goal_ = 0, least_goal_ = 0;  ///< [norm_D]
  Real first_ = std::numeric_limits<Real>::infinity(), best_ = first_,
       drop_from_ = first_;  ///< violations
  bool gives_up_early_ = false, gave_up_ = false;
  Real affordable_ = std::numeric_limits<Real>::infinity();  ///< cycles
  int without_progress_ = 0, without_drop_ = 0, retreats_ = 0, drifts_ = 0;
  StepCounts steps_;
  Index iterations_ = 0, updates_ = 0, max_iterations_ = 0;
};

}  // namespace frictioncg
