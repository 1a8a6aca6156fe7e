#pragma once
#include "gradient/anderson.h"
#include "solution.h"
#include "gradient/tresca.h"

namespace frictioncg {

/// Problem 1 (section 2), g = mu |F_N(u_g)|: minimizations at given g, each started from the last
/// and no more precise than g is known; g accelerated. A given sliding limit takes one
/// minimization.
class FixedPoint {
 public:
  FixedPoint(const ContactProblem& problem, const Settings& settings, TrescaSolver& tresca);
  Solution solve(const Vector& x0);

 private:
  void start(const Vector& x0);
  Status pass();
  bool update_sliding_limit();
  bool sharpen_regularization();
  Real displacement_scale() const;

  const ContactProblem& problem_;
  const Settings& settings_;
  TrescaSolver& tresca_;
  Iterate it_;
  Vector g_;
  Anderson anderson_;
  Solution solution_;
  Real relative_eps_;  ///< eps over the displacement scale, where eps is ours to choose
  Real inner_ = 0;     ///< tolerance of the next minimization
  Real precision_ = 0.1;  ///< of a minimization, over the mismatch that it is to improve
  Real best_ = 0;      ///< least mismatch |mu r_N - g| so far, in norm_D over the load
  Index since_best_ = 0;
  bool damped_ = false;
};

}  // namespace frictioncg
