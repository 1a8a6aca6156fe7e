#pragma once
#include "gradient/line_search.h"
#include "gradient/preconditioner.h"
#include "gradient/tresca.h"

namespace frictioncg {

/// Minimizes J_eps at given g over x_N <= gap by projected conjugate gradients.   sections 3 to 5
class ProjectedCG final : public TrescaSolver {
 public:
  ProjectedCG(const ContactProblem& problem, const Settings& settings, Index max_iterations,
              Observer* observer);

  Outcome minimize(Iterate& it, const Vector& g, Real eps, Tangents tangents,
                   Real tolerance) override;
  bool regularized() const override { return settings_.method != Method::gcx; }

 private:
  struct Verdict {
    bool stop = false, restart = false;
  };

  void begin(Iterate& it, const Vector& g, const Phi& phi);
  void recompute_residual(const Iterate& it);
  bool hold_inward(Iterate& it, const Vector& g, const Phi& phi);
  Real step_to_gap(const Iterate& it) const;
  bool close_gaps(Iterate& it, Real rho, Real rho_gap);
  Real release_threshold(Real tolerance) const;
  bool release_tensile(Iterate& it, Real tolerance);
  bool release_by_descent(Iterate& it, const Vector& g, Real tolerance);
  bool freeze_stick(Iterate& it, const Vector& g, Real rho);
  void displace(Iterate& it, Index c, Real dx);
  void settle_displacements();
  Real friction_part_along_v() const;
  Real dual_violation(const Iterate& it, const Vector& g) const;
  bool update_friction(const Iterate& it, const Vector& g, const Phi& phi);
  Verdict judge(Iterate& it, const Vector& g, const Phi& phi, Real rho, Real tolerance);
  Real free_norm_if_below(Real bound);
  void contact_rows_times_v();

  const ContactProblem& problem_;
  const Settings& settings_;
  const Index max_iterations_;
  Observer* const observer_;
  const Vector& D_;
  std::unique_ptr<Preconditioner> P_;
  LineSearch line_search_;
  Tangents tangents_ = Tangents::sliding;
  ContactPart part_;
  std::vector<char> stick_;       ///< m, gcx: held at x_T = 0
  Vector dx_C_, d_C_, Ad_C_;
  std::vector<char> sticking_;    ///< m, |x_T| <= eps: the node's piece of REG3
  Vector v_, Av_C_, r_C_, rf_C_;  ///< r_C without friction, rf_C with it, zero where held
  Real partial_ = 0;              ///< eps_1/eps_0 at present
  Real norm_ratio_ = 1;           ///< last measured |r_free| over <r, Pr>^(1/2)
  Index since_measured_ = 0;
  Index iterations_ = 0;  ///< over all minimizations
};

}  // namespace frictioncg
