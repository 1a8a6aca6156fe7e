#include "gradient/multigrid.h"

#include "model/contact_problem.h"

namespace frictioncg {

namespace {

constexpr Real stiff = 100;     ///< J'' over D from which on A does not matter to a tangent
constexpr Real outdated = 0.5;  ///< change of J'' over D + J'' with which the hierarchy is cut anew

}  // namespace

MultigridPreconditioner::MultigridPreconditioner(const System& system)
    : Preconditioner(system),
      hierarchy_(make_hierarchy(system)),
      r_(Vector::Zero(system.dofs())),
      dr_(Vector::Zero(system.dofs())),
      Av_(Vector::Zero(system.dofs())),
      springs_(Vector::Zero(system.contact_dofs())) {
  if (!hierarchy_)
    throw IllegalInput(
        "precon=\"multigrid\" needs the mesh nodes and the rigid motions of A, as displacements in "
        "P1 or P2 on one mesh have them; take precon=\"hessian-ssor\"");
}

void MultigridPreconditioner::start(const Vector& r) {
  r_ = r;
  dr_.setZero();
  z_is_old_ = true;
}

/// Whether the hierarchy as it is cut now is still one for these faces and this J''.
bool MultigridPreconditioner::fits(const ContactPart& part) const {
  if (cut_.empty()) return false;
  for (Index c = 0; c < springs_.size(); ++c) {
    const Real D = D_[interior_ + c], H = part.hessian[c];
    const bool cut = !part.free[c] || H > stiff * D;
    if (cut != bool(cut_[c])) return false;
    if (!cut && std::abs(H - springs_[c]) > outdated * (D + springs_[c])) return false;
  }
  return true;
}

void MultigridPreconditioner::set_contact(const Vector& r_C, const ContactPart& part) {
  for (Index c = 0; c < r_C.size(); ++c) {
    const Real before = r_[interior_ + c], now = part.free[c] ? r_C[c] : 0;
    dr_[interior_ + c] = now - before;
    r_[interior_ + c] = now;
  }
  free_ = part.free;
  hessian_ = part.hessian;
  z_is_old_ = true;
  if (fits(part)) return;
  cut_.assign(free_.size(), 0);
  for (Index c = 0; c < springs_.size(); ++c) {
    cut_[c] = !free_[c] || hessian_[c] > stiff * D_[interior_ + c];
    springs_[c] = cut_[c] ? 0 : hessian_[c];
  }
  hierarchy_->truncate(cut_, {}, springs_);
}

/// A call without a further step needs none: hence only on demand.
const Vector& MultigridPreconditioner::z() const {
  if (!z_is_old_) return z_;
  z_is_old_ = false;
  hierarchy_->apply(r_, z_);
  for (Index c = 0; c < springs_.size(); ++c) {
    const Index i = interior_ + c;
    if (cut_[c]) z_[i] = free_[c] ? r_[i] / (D_[i] + hessian_[c]) : 0;
  }
  products_ = {r_.dot(z_), dr_.dot(z_)};
  return z_;
}

void MultigridPreconditioner::direction(Real gamma, Vector& v) { v = z() + gamma * v; }

Curvature MultigridPreconditioner::curvature(const Vector& v) {
  Av_.noalias() = system_.A * v;
  return {Av_.dot(v), (D_.array() * v.array().square()).sum()};
}

void MultigridPreconditioner::advance(Real rho, const Vector& v, Vector& x) {
  x += rho * v;
  dr_.head(interior_) = -rho * Av_.head(interior_);
  r_.head(interior_) += dr_.head(interior_);
}

/// The contact rows hold A_CI, and with it A_IC.
void MultigridPreconditioner::move_contact(const Vector& dx_C) {
  for (Index c = 0; c < dx_C.size(); ++c) {
    if (dx_C[c] == 0) continue;
    for (Matrix::InnerIterator a(system_.A, interior_ + c); a && a.col() < interior_; ++a)
      r_[a.col()] -= a.value() * dx_C[c];
  }
}

Real MultigridPreconditioner::free_norm() const { return norm_D(system_, r_); }

}  // namespace frictioncg
