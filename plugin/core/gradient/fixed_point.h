#pragma once
#include "gradient/anderson.h"
#include "gradient/tresca.h"
#include "solution.h"

namespace frictioncg {

/// Problem 1 (section 2), g = mu |F_N(u_g)| of (1): minimizations at given g, each started from the
/// last and no more precise than g is known; g accelerated. A given sliding limit takes one
/// minimization.
///
/// Status: converged where the certificate is within tol; fixed_point_diverged where the passes no
/// longer improve g, damped or not; regularized where eps is what keeps the certificate above tol;
/// stagnated where rounding is; else what ended the last minimization.
class FixedPoint {
 public:
  FixedPoint(const ContactProblem& problem, const Settings& settings, TrescaSolver& tresca);

  /// x0: n, or empty to start from sticking contact.
  Solution solve(const Vector& x0);

 private:
  void start(const Vector& x0);
  void minimize(Tangents tangents, Real bound);
  bool improve(Real& last);
  bool update_sliding_limit();
  Real measure_image();
  void judge_progress(Real mismatch);
  void sharpen_pass(Real mismatch);
  void step_towards_image(bool learnt);
  bool sharpen_regularization();
  Real finest() const;
  Real displacement_scale() const;
  Vector sliding_limits() const;

  const ContactProblem& problem_;
  const Settings& settings_;
  TrescaSolver& tresca_;
  const bool coulomb_;
  Solution solution_;
  Vector g_;      ///< m [force]
  Vector image_;  ///< m, G(g)
  Anderson anderson_;
  Real relative_eps_;  ///< eps over the displacement scale, where eps is ours to choose
  Real inner_ = 0;     ///< bound of the next minimization, over the certificate's scale
  Real precision_;     ///< a minimization solves to this share of the mismatch of g
  Real best_;          ///< least mismatch |G(g) - g| so far, over the scale
  Index since_best_ = 0;
  bool damped_ = false;
};

}  // namespace frictioncg
