#pragma once
#include "gradient/preconditioner.h"
#include "settings.h"

namespace frictioncg {

/// What is left to do, against eps_0: the norm of the residual on the free dofs. Measuring it costs
/// half a pass over A, so <r, P r>, which is there anyway, tells when it is worth it.
///
/// To repeat the paper's tables (settings.stop_on_step) it is |dx|/|x| instead.
class StoppingTest {
 public:
  explicit StoppingTest(const Settings& settings) : stop_on_step_(settings.stop_on_step) {}

  void start(Real bound) {
    eps_0_ = by_step() ? stop_on_step_ : bound;
    ratio_ = 0;
    since_ = 0;
  }
  bool by_step() const { return stop_on_step_ > 0; }
  Real eps_0() const { return eps_0_; }

  /// The measure after the step dx = rho v to x, or infinity where it is surely above `wanted`.
  Real left(const Preconditioner& P, Real wanted, Real rho, const Vector& v, const Vector& x) {
    if (by_step()) return rho > 0 ? rho * v.norm() / x.norm() : infinity;
    const Real r_z = std::sqrt(std::max(P.r_z(), 0.0));
    if (ratio_ * r_z > wanted && ++since_ < measure_every) return infinity;
    const Real norm = P.free_norm();
    since_ = 0;
    ratio_ = r_z > 0 ? norm / r_z : 0;
    return norm;
  }

 private:
  /// After so many iterations the ratio is measured anew, which costs half a pass over A.
  static constexpr Index measure_every = 20;

  const Real stop_on_step_;
  Real eps_0_ = 0;
  Real ratio_ = 0;  ///< last measured |r_free| over <r, P r>^(1/2)
  Index since_ = 0;
};

}  // namespace frictioncg
