#include "gradient/iterate.h"

namespace frictioncg {

ContactRows::ContactRows(const ContactProblem& problem)
    : system_(*problem.system),
      r_(Vector::Zero(problem.contact_dofs())),
      dx_C_(Vector::Zero(problem.contact_dofs())) {}

void ContactRows::advance(Real rho, const Vector& v) {
  for (Index c = 0; c < r_.size(); ++c)
    r_[c] -= rho * row_product(system_, system_.interior() + c, v);
}

void ContactRows::owe(Index c, Real dx) {
  if (dx == 0) return;
  dx_C_[c] += dx;
  displaced_ = true;
}

void ContactRows::displace(Vector& x, Index c, Real dx) {
  const auto [row, col, a] = arrays_of(system_.entries());
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
  const auto [row, col, a] = arrays_of(system_.entries());
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

namespace {
/// A node has reached its gap where it misses no more than this share of the gap and of the step.
constexpr Real rounding = 1e-15;
}  // namespace

ActiveSet::ActiveSet(const ContactProblem& problem)
    : problem_(problem),
      system_(*problem.system),
      contact_(problem.nodes(), 0),
      stick_(problem.nodes(), 0) {}

void ActiveSet::start(Vector& x, const Vector& g, Tangents tangents, bool stick_is_a_face) {
  const Increment& now = problem_.increment;
  stuck_ = tangents == Tangents::stuck;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = system_.first[i], t = system_.tangents(i);
    x[N] = now.bilateral ? now.gap[i] : std::min(x[N], now.gap[i]);
    contact_[i] = x[N] == now.gap[i];
    auto x_T = x.segment(N + 1, t);
    if (stuck_) x_T.setZero();
    stick_[i] = !stuck_ && stick_is_a_face && t > 0 && g[i] > 0 && x_T.isZero(0);
  }
}

Real ActiveSet::step_to_gap(const Vector& x, const Vector& v) const {
  Real rho = infinity;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = system_.first[i];
    if (!contact_[i] && v[N] > 0) rho = std::min(rho, (problem_.increment.gap[i] - x[N]) / v[N]);
  }
  return std::max(rho, 0.0);
}

bool ActiveSet::close_gaps(Vector& x, const Vector& v, Real rho) {
  bool closed = false;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = system_.first[i];
    const Real gap = problem_.increment.gap[i];
    if (contact_[i] || v[N] <= 0) continue;
    if (x[N] < gap - rounding * std::abs(gap) - rounding * rho * v[N]) continue;
    x[N] = gap;
    contact_[i] = 1;
    closed = true;
  }
  return closed;
}

bool ActiveSet::activate_blocked(const Vector& x, const Vector& v) {
  bool blocked = false;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = system_.first[i];
    if (contact_[i] || v[N] <= 0 || x[N] < problem_.increment.gap[i]) continue;
    contact_[i] = 1;
    blocked = true;
  }
  return blocked;
}

bool ActiveSet::open_tensile(const Vector& r_C, Real threshold) {
  bool opened = false;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    if (tension(i, r_C) <= threshold * std::sqrt(system_.weight[system_.first[i]])) continue;
    contact_[i] = 0;
    opened = true;
  }
  return opened;
}

Real ActiveSet::tension(Index i, const Vector& r_C) const {
  if (!contact_[i] || problem_.increment.bilateral) return 0;
  return std::max(-r_C[system_.first[i] - system_.interior()], 0.0);
}

Real ActiveSet::stick_excess(Index i, const Vector& r_C, const Vector& g) const {
  if (!stick_[i]) return 0;
  const Index T = system_.first[i] + 1 - system_.interior();
  return std::max(r_C.segment(T, system_.tangents(i)).norm() - g[i], 0.0);
}

Real ActiveSet::violation(const Vector& r_C, const Vector& g) const {
  Real sum = 0;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = system_.first[i];
    const Real normal = tension(i, r_C), tangential = stick_excess(i, r_C, g);
    if (normal > 0) sum += normal * normal / system_.weight[N];
    if (tangential > 0) sum += tangential * tangential / system_.weight[N + 1];
  }
  return std::sqrt(sum);
}

Iterate::Iterate(const ContactProblem& problem)
    : system(*problem.system),
      rows(problem),
      faces(problem),
      part{std::vector<char>(problem.contact_dofs(), 1), Vector::Zero(problem.contact_dofs())},
      piece_(problem.nodes(), 0) {}

bool Iterate::update_friction() {
  bool crossed = false;
  r = rows.r();
  for (Index i = 0; i < system.nodes(); ++i) {
    const Index c = system.first[i] - system.interior(), t = system.tangents(i);
    part.free[c] = !faces.contact(i);
    if (faces.contact(i)) r[c] = 0;
    for (Index k = 1; k <= t; ++k) part.free[c + k] = !faces.at_rest(i);
    part.hessian.segment(c + 1, t).setZero();
    if (faces.at_rest(i)) {
      r.segment(c + 1, t).setZero();
    } else if (t > 0 && g[i] > 0) {
      const auto x_T = x.segment(system.first[i] + 1, t);
      const Real slip = x_T.norm();
      r.segment(c + 1, t) -= g[i] * phi.slope_over_t(slip) * x_T;
      part.hessian.segment(c + 1, t).setConstant(g[i] * phi.mean_second_derivative(slip, t));
      const char piece = phi.eps > 0 ? slip <= phi.eps : t == 1 && x_T[0] > 0;
      crossed |= std::exchange(piece_[i], piece) != piece;
    }
  }
  return crossed;
}

}  // namespace frictioncg
