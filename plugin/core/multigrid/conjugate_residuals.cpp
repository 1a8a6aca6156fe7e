#include "multigrid/conjugate_residuals.h"

namespace frictioncg {

namespace {

/// A new direction is made orthogonal to so many of the last ones.
constexpr std::size_t most_directions = 20;
/// A is not positive semi-definite where -<Az,z>/<Dz,z> is larger: rounding makes no more.
constexpr Real negative = 1e-10;
/// A direction of which this share of |Jz|^2 is left beside the others is rounding.
constexpr Real dependent = 1e-20;

}  // namespace

ConjugateResiduals::ConjugateResiduals(const System& system)
    : system_(system), inverse_weight_(system.weight.cwiseInverse()) {}

/// The part of this process in the product of norm_D.
Real ConjugateResiduals::dot(const Vector& a, const Vector& b) const {
  return (a.array() * inverse_weight_.array() * b.array()).sum();
}

void ConjugateResiduals::start(const Vector& s) {
  s_ = s;
  norm_ = std::sqrt(system_.sum(dot(s_, s_)));
  used_ = next_ = 0;
}

bool ConjugateResiduals::step(Hierarchy& hierarchy, const Faces& faces, const Vector& springs,
                              Vector& x, Vector& b_C) {
  if (kept_.size() < most_directions && next_ == kept_.size()) kept_.emplace_back();
  Direction& now = kept_[next_];
  hierarchy.apply(s_, now.z);
  if (!hierarchy.multiply(now.z, now.Jz)) system_.multiply(now.z, now.Jz);
  const Real work = now.z.dot(now.Jz), size = now.z.dot(system_.D.cwiseProduct(now.z));
  now.Az_C = now.Jz.tail(springs.size()) + springs.cwiseProduct(now.z.tail(springs.size()));
  faces.jacobian(now.z, now.Az_C, now.Jz.tail(system_.contact_dofs()));
  if (!make_orthogonal(now, work, size)) return false;
  Real along[] = {dot(now.Jz, now.Jz), dot(s_, now.Jz)};
  system_.sum(along, 2);
  now.size = along[0];
  if (!(now.size > dependent * before_)) return false;
  const Real alpha = along[1] / now.size;
  x += alpha * now.z;
  s_ -= alpha * now.Jz;
  b_C -= alpha * now.Az_C;
  norm_ = std::sqrt(system_.sum(dot(s_, s_)));
  used_ = std::max(used_, next_ + 1);
  next_ = (next_ + 1) % most_directions;
  return alpha != 0;
}

/// Takes the directions before out of a new one, by one sum over all processes (classical
/// Gram-Schmidt). work, size: the parts of this process in <Az,z> and <Dz,z>; false where A did
/// negative work.
bool ConjugateResiduals::make_orthogonal(Direction& now, Real work, Real size) {
  std::array<Real, most_directions + 3> products{work, size, dot(now.Jz, now.Jz)};
  for (std::size_t k = 0; k < used_; ++k)
    if (&kept_[k] != &now) products[k + 3] = dot(now.Jz, kept_[k].Jz);
  system_.sum(products.data(), static_cast<Index>(used_) + 3);
  before_ = products[2];
  indefinite_ = products[0] < -negative * products[1];
  if (indefinite_) return false;
  for (std::size_t k = 0; k < used_; ++k) {
    const Direction& old = kept_[k];
    if (&old == &now) continue;
    const Real along = products[k + 3] / old.size;
    now.z -= along * old.z;
    now.Jz -= along * old.Jz;
    now.Az_C -= along * old.Az_C;
  }
  return true;
}

}  // namespace frictioncg
