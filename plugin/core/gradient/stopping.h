#pragma once
#include "gradient/preconditioner.h"
#include "settings.h"

namespace frictioncg {

/// A measure that costs about half a pass over A, and what is known anyway and about proportional
/// to it, which tells when it is worth its cost.
class RareMeasure {
 public:
  /// Measures, or tells infinity where it is surely above `wanted`.
  template <class Measure>
  Real operator()(Real known, Real wanted, const Measure& measure) {
    if (ratio_ * known > wanted && ++since_ < measure_every) return infinity;
    const Real measured = measure();
    since_ = 0;
    ratio_ = known > 0 ? measured / known : 0;
    return measured;
  }

 private:
  static constexpr Index measure_every = 20;  ///< after so many times it is in any case
  Real ratio_ = 0;                            ///< of the last measure over what was known then
  Index since_ = 0;
};

/// What is left to do, against eps_0: the norm of the residual on the free dofs, by <r, P r>.
///
/// To repeat the paper's tables (settings.stop_on_step) it is |dx|/|x| instead.
class StoppingTest {
 public:
  explicit StoppingTest(const Settings& settings) : stop_on_step_(settings.stop_on_step) {}

  void start(Real bound) {
    eps_0_ = by_step() ? stop_on_step_ : bound;
    norm_ = {};
  }
  bool by_step() const { return stop_on_step_ > 0; }
  Real eps_0() const { return eps_0_; }

  /// The measure after the step dx = rho v to x, or infinity where it is surely above `wanted`.
  Real left(const Preconditioner& P, Real wanted, Real rho, const Vector& v, const Vector& x) {
    if (by_step()) return rho > 0 ? rho * v.norm() / x.norm() : infinity;
    return norm_(std::sqrt(std::max(P.r_z(), 0.0)), wanted, [&] { return P.free_norm(); });
  }

 private:
  const Real stop_on_step_;
  Real eps_0_ = 0;
  RareMeasure norm_;
};

}  // namespace frictioncg
