#include "multigrid/conjugate_residuals.h"

#include <algorithm>
#include <cmath>

namespace frictioncg {

namespace {

constexpr std::size_t most_directions = 20;
constexpr Real negative = 1e-10;   ///< -<Az,z>/<Dz,z> that is no rounding
constexpr Real dependent = 1e-20;  ///< share of |Jz|^2 beside the directions before: rounding

}  // namespace

ConjugateResiduals::ConjugateResiduals(const System& system)
    : system_(system), inverse_weight_(system.weight.cwiseInverse()) {}

/// The product of norm_D.
Real ConjugateResiduals::dot(const Vector& a, const Vector& b) const {
  return (a.array() * inverse_weight_.array() * b.array()).sum();
}

void ConjugateResiduals::start(const Vector& s) {
  s_ = s;
  norm_ = std::sqrt(dot(s_, s_));
  used_ = next_ = 0;
}

bool ConjugateResiduals::step(Hierarchy& hierarchy, const Faces& faces, const Vector& springs,
                              Vector& x, Vector& b_C) {
  if (kept_.size() < most_directions && next_ == kept_.size()) kept_.emplace_back();
  Direction& now = kept_[next_];
  hierarchy.apply(s_, now.z);
  now.Jz.noalias() = system_.A * now.z;
  const Real work = now.z.dot(now.Jz), size = now.z.dot(system_.D.cwiseProduct(now.z));
  indefinite_ = work < -negative * size;
  if (indefinite_) return false;
  now.Az_C = now.Jz.tail(springs.size()) + springs.cwiseProduct(now.z.tail(springs.size()));
  faces.jacobian(now.z, now.Az_C, now.Jz.tail(system_.contact_dofs()));
  const Real before = dot(now.Jz, now.Jz);
  for (std::size_t k = 0; k < used_; ++k) {
    const Direction& old = kept_[k];
    if (&old == &now) continue;
    const Real along = dot(now.Jz, old.Jz) / old.size;
    now.z -= along * old.z;
    now.Jz -= along * old.Jz;
    now.Az_C -= along * old.Az_C;
  }
  now.size = dot(now.Jz, now.Jz);
  if (!(now.size > dependent * before)) return false;
  const Real alpha = dot(s_, now.Jz) / now.size;
  x += alpha * now.z;
  s_ -= alpha * now.Jz;
  b_C -= alpha * now.Az_C;
  norm_ = std::sqrt(dot(s_, s_));
  used_ = std::max(used_, next_ + 1);
  next_ = (next_ + 1) % most_directions;
  return alpha != 0;
}

}  // namespace frictioncg
