#include "gradient/residual_preconditioner.h"

#include "model/contact_problem.h"

namespace frictioncg {

ResidualPreconditioner::ResidualPreconditioner(const System& system)
    : Preconditioner(system),
      r_(Vector::Zero(system.dofs())),
      dr_(Vector::Zero(system.dofs())),
      Av_(Vector::Zero(system.dofs())) {}

void ResidualPreconditioner::start(const Vector& r) {
  r_ = r;
  dr_.setZero();
  z_is_old_ = true;
}

void ResidualPreconditioner::set_contact(const Vector& r_C, const ContactPart& part) {
  for (Index c = 0; c < r_C.size(); ++c) {
    const Real before = r_[interior_ + c], now = part.free[c] ? r_C[c] : 0;
    dr_[interior_ + c] = now - before;
    r_[interior_ + c] = now;
  }
  z_is_old_ = true;
  update(part);
}

const Vector& ResidualPreconditioner::z() const {
  if (!z_is_old_) return z_;
  z_is_old_ = false;
  apply(r_, z_);
  products_ = {r_.dot(z_), dr_.dot(z_)};
  return z_;
}

void ResidualPreconditioner::direction(Real gamma, Vector& v) { v = z() + gamma * v; }

Curvature ResidualPreconditioner::curvature(const Vector& v) {
  system_.multiply(v, Av_);
  return {Av_.dot(v), (D_.array() * v.array().square()).sum()};
}

void ResidualPreconditioner::advance(Real rho, const Vector& v, Vector& x) {
  x += rho * v;
  dr_.head(interior_) = -rho * Av_.head(interior_);
  r_.head(interior_) += dr_.head(interior_);
}

void ResidualPreconditioner::move_contact(const Vector& dx_C) { system_.move_contact(dx_C, r_); }

Real ResidualPreconditioner::free_norm() const { return norm_D(system_, r_); }

}  // namespace frictioncg
