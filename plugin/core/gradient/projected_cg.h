#pragma once
#include "gradient/bent_path.h"
#include "gradient/friction_term.h"
#include "gradient/iterate.h"
#include "gradient/line_search.h"
#include "gradient/preconditioner.h"
#include "gradient/release_rule.h"
#include "gradient/stopping.h"
#include "gradient/tresca.h"

namespace frictioncg {

/// Problem 4 of (10): minimizes J_eps at given g over x_N <= gap by conjugate gradients projected
/// on the faces of the present contact.   sections 3 to 5
///
///   r = F - Ax - g phi'(x_T), 0 on held dofs               -J' of (11)
///   repeat
///     v = P r + gamma v, gamma of (12), P of (15)           P and v on the free dofs only
///     rho of (13) or (14), at most up to the first gap
///     x += rho v
///     nodes that reached their gap are held; restart
///     release of held nodes, as the rule of GC1, GC2, GC3 or GCX wants it; restart
///   until |r_free|^2 + |violation|^2 <= eps_0^2             in norm_D
///
/// gamma is cut off at 0, and a restart follows a node that crosses eps (REG3, exact step): J has
/// another quadratic form from there on.
class ProjectedCG final : public TrescaSolver {
 public:
  /// max_iterations bounds all minimizations together. The observer may be null.
  ProjectedCG(const ContactProblem& problem, const Settings& settings, Index max_iterations,
              Observer* observer);

  Outcome minimize(Vector& x, const Vector& g, Real eps, Tangents tangents, Real bound) override;
  bool regularized() const override { return !rule_.stick_is_a_face(); }

 private:
  /// What an iteration, or the start, has led to.
  struct Events {
    bool contact_hit = false, stick_frozen = false, released = false, crossed = false;
    bool expanded = false;
    bool restart = true;  ///< the direction of the next iteration
    bool stop = false;
    /// The one label of the iteration that led to it, along P r alone or not.
    StepLabel label(bool restarted) const;
  };

  Events begin(const Vector& g, Tangents tangents, Real bound);
  Status direct(bool restart, Line& line);
  Status search(Line& line, Real& rho, Real& rho_gap);
  Events advance(const Line& line, Real rho, Real rho_gap);
  void stop_or_release(Events& events, Real rho);
  bool update_friction();

  const ContactProblem& problem_;
  const Settings& settings_;
  const Index max_iterations_;
  Observer* const observer_;
  const Vector stiffness_;  ///< m, of A_TT
  ReleaseRule rule_;
  const std::unique_ptr<Preconditioner> P_;
  LineSearch line_search_;
  StoppingTest stopping_;
  FrictionTerm friction_;
  Iterate it_;
  BentPath path_;
  Phi phi_;
  Vector v_;              ///< n, the direction
  Vector residual_;       ///< n, of the start
  Real r_z_ = 0;          ///< <r, P r> of the last direction
  Real least_ = 0;        ///< violations of a face up to here are left to the tolerance
  Index iterations_ = 0;  ///< over all minimizations
};

}  // namespace frictioncg
