#include "gradient/contact_rows.h"

#include <cmath>

namespace frictioncg {

ContactRows::ContactRows(const ContactProblem& problem)
    : system_(*problem.system),
      r_(Vector::Zero(problem.contact_dofs())),
      dx_C_(Vector::Zero(problem.contact_dofs())) {}

Real ContactRows::row_product(Index c, const Vector& v_in) const {
  const Index* row = system_.entries().outerIndexPtr();
  const Index* col = system_.entries().innerIndexPtr();
  const Real *a = system_.entries().valuePtr(), *v = v_in.data();
  const Index i = system_.interior() + c;
  Real sum = 0;
  for (Index k = row[i]; k < row[i + 1]; ++k) sum += a[k] * v[col[k]];
  return sum;
}

void ContactRows::advance(Real rho, const Vector& v) {
  for (Index c = 0; c < r_.size(); ++c) r_[c] -= rho * row_product(c, v);
}

void ContactRows::owe(Index c, Real dx) {
  if (dx == 0) return;
  dx_C_[c] += dx;
  displaced_ = true;
}

void ContactRows::displace(Vector& x, Index c, Real dx) {
  const Index* row = system_.entries().outerIndexPtr();
  const Index* col = system_.entries().innerIndexPtr();
  const Real* a = system_.entries().valuePtr();
  const Index interior = system_.interior(), i = interior + c;
  x[i] += dx;
  owe(c, dx);
  for (Index k = row[i + 1] - 1; k >= row[i] && col[k] >= interior; --k)
    r_[col[k] - interior] -= a[k] * dx;
}

void ContactRows::settle(Preconditioner& P) {
  if (!displaced_) return;
  P.move_contact(dx_C_);
  dx_C_.setZero();
  displaced_ = false;
}

Real ContactRows::energy(const Vector& d) const {
  const Index* row = system_.entries().outerIndexPtr();
  const Index* col = system_.entries().innerIndexPtr();
  const Real* a = system_.entries().valuePtr();
  const Index interior = system_.interior();
  Real sum = 0;
  for (Index c = 0; c < d.size(); ++c) {
    if (d[c] == 0) continue;
    const Index i = interior + c;
    for (Index k = row[i + 1] - 1; k >= row[i] && col[k] >= interior; --k)
      sum += d[c] * a[k] * d[col[k] - interior];
  }
  return sum;
}

Vector tangential_stiffness(const System& system) {
  Vector stiffness = Vector::Zero(system.nodes());
  for (Index i = 0; i < system.nodes(); ++i) {
    const Index T = system.first[i] + 1, t = system.tangents(i);
    if (t == 1) stiffness[i] = system.D[T];
    if (t != 2) continue;
    const Real off = system.entries().coeff(T, T + 1), half = (system.D[T] - system.D[T + 1]) / 2;
    stiffness[i] = (system.D[T] + system.D[T + 1]) / 2 + std::hypot(half, off);
  }
  return stiffness;
}

}  // namespace frictioncg
