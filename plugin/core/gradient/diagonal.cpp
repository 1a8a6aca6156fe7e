#include "gradient/diagonal.h"

#include "model/contact_problem.h"

namespace frictioncg {

DiagonalPreconditioner::DiagonalPreconditioner(const System& system, Precon kind)
    : Preconditioner(system),
      on_hessian_(kind == Precon::hessian_diagonal),
      C_(kind == Precon::none ? Vector::Ones(system.dofs()) : Vector(D_)),
      r_(Vector::Zero(system.dofs())),
      Av_(Vector::Zero(system.dofs())) {}

void DiagonalPreconditioner::start(const Vector& r) {
  r_ = r;
  interior_r_z_ = (r_.head(interior_).array().square() / C_.head(interior_).array()).sum();
  interior_dr_z_ = 0;
}

void DiagonalPreconditioner::set_contact(const Vector& r_C, const ContactPart& part) {
  r_z_ = interior_r_z_;
  dr_z_ = interior_dr_z_;
  for (Index c = 0; c < r_C.size(); ++c) {
    const Index i = interior_ + c;
    const Real before = r_[i];
    r_[i] = part.free[c] ? r_C[c] : 0;
    if (on_hessian_) C_[i] = D_[i] + part.hessian[c];
    r_z_ += r_[i] * r_[i] / C_[i];
    dr_z_ += (r_[i] - before) * r_[i] / C_[i];
  }
}

void DiagonalPreconditioner::direction(Real gamma, Vector& v) {
  v = r_.cwiseQuotient(C_) + gamma * v;
}

Curvature DiagonalPreconditioner::curvature(const Vector& v) {
  Av_.noalias() = system_.A * v;
  return {Av_.dot(v), (D_.array() * v.array().square()).sum()};
}

void DiagonalPreconditioner::advance(Real rho, const Vector& v, Vector& x) {
  x += rho * v;
  interior_r_z_ = interior_dr_z_ = 0;
  for (Index i = 0; i < interior_; ++i) {
    r_[i] -= rho * Av_[i];
    const Real z = r_[i] / C_[i];
    interior_r_z_ += r_[i] * z;
    interior_dr_z_ -= rho * Av_[i] * z;
  }
}

/// The contact rows hold A_CI, and with it A_IC.
void DiagonalPreconditioner::move_contact(const Vector& dx_C) {
  for (Index c = 0; c < dx_C.size(); ++c) {
    if (dx_C[c] == 0) continue;
    for (Matrix::InnerIterator a(system_.A, interior_ + c); a && a.col() < interior_; ++a)
      r_[a.col()] -= a.value() * dx_C[c];
  }
  interior_r_z_ = (r_.head(interior_).array().square() / C_.head(interior_).array()).sum();
}

Real DiagonalPreconditioner::free_norm() const { return norm_D(system_, r_); }

}  // namespace frictioncg
