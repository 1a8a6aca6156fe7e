#include "gradient/stopping.h"

#include <cmath>
#include <limits>

namespace frictioncg {

namespace {
constexpr Real infinity = std::numeric_limits<Real>::infinity();
/// After so many iterations the ratio is measured anew, which costs half a pass over A.
constexpr Index measure_every = 20;
}  // namespace

void StoppingTest::start(Real bound) {
  eps_0_ = by_step() ? stop_on_step_ : bound;
  ratio_ = 0;
  since_ = 0;
}

Real StoppingTest::left(const Preconditioner& P, Real wanted, Real rho, const Vector& v,
                        const Vector& x) {
  if (by_step()) return rho > 0 ? rho * v.norm() / x.norm() : infinity;
  const Real r_z = std::sqrt(std::max(P.r_z(), 0.0));
  if (ratio_ * r_z > wanted && ++since_ < measure_every) return infinity;
  const Real norm = P.free_norm();
  since_ = 0;
  ratio_ = r_z > 0 ? norm / r_z : 0;
  return norm;
}

}  // namespace frictioncg
