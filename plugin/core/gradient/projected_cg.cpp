#include "gradient/projected_cg.h"

#include <cmath>
#include <limits>

namespace frictioncg {

namespace {
constexpr Real infinity = std::numeric_limits<Real>::infinity();
constexpr Real indefinite = -1e-11;  ///< <Av,v>/<Dv,v> below which A is not positive semi-definite
constexpr Index measure_every = 20;

/// The paper's 1, unless the script says otherwise; measured, 1.5 takes half the iterations.
Real relaxation(const Settings& settings) {
  if (settings.omega > 0) return settings.omega;
  return settings.method == Method::gcx ? 1.5 : 1;
}
}  // namespace

ProjectedCG::ProjectedCG(const ContactProblem& problem, const Settings& settings,
                         Index max_iterations, Observer* observer)
    : problem_(problem),
      settings_(settings),
      max_iterations_(max_iterations),
      observer_(observer),
      D_(problem.system->D),
      P_(make_preconditioner(*problem.system, settings.precon, relaxation(settings))),
      line_search_(*problem.system, settings.step),
      part_{std::vector<char>(problem.contact_dofs(), 1), Vector::Zero(problem.contact_dofs())},
      stick_(problem.nodes(), 0),
      dx_C_(Vector::Zero(problem.contact_dofs())),
      d_C_(problem.contact_dofs()),
      Ad_C_(problem.contact_dofs()),
      sticking_(problem.nodes(), 0),
      v_(Vector::Zero(problem.dofs())),
      Av_C_(problem.contact_dofs()),
      r_C_(problem.contact_dofs()),
      rf_C_(problem.contact_dofs()) {}

Outcome ProjectedCG::minimize(Iterate& it, const Vector& g, Real eps, Tangents tangents,
                              Real tolerance) {
  const Phi phi = regularized() ? Phi{settings_.reg, eps} : Phi{Regularization::polynomial, 0};
  const Index first_iteration = iterations_;
  const auto end = [&](Status s) { return Outcome{s, iterations_ - first_iteration}; };
  tangents_ = tangents;
  partial_ = settings_.partial;
  begin(it, g, phi);  // r = F - Ax - g phi'
  Verdict verdict = judge(it, g, phi, 0, tolerance);
  verdict.restart = true;
  Real r_z = P_->r_z();

  while (!verdict.stop) {
    if (iterations_ >= max_iterations_) return end(Status::max_iterations);
    ++iterations_;
    const Real gamma = verdict.restart || r_z <= 0 ? 0 : std::max(0.0, P_->dr_z() / r_z);
    P_->direction(gamma, v_);  // v = P r + gamma v   (12)
    if (gamma != 0 && P_->r_v(v_) <= 0) P_->direction(0, v_);
    while (regularized() && hold_inward(it, g, phi)) P_->direction(0, v_);
    const Real r_v = P_->r_v(v_);
    if (!(r_v > 0)) return end(Status::stagnated);  // all is held again: no way down
    const Curvature vAv = P_->curvature(v_);
    if (vAv.A < indefinite * vAv.D) return end(Status::not_positive_definite);

    const Real rho_gap = step_to_gap(it);
    const Real a = r_v + friction_part_along_v();                           // <F - Ax, v>
    const Real rho = line_search_(phi, g, it.x, v_, r_v, a, vAv, rho_gap);  // (13) or (14)
    if (rho == infinity) return end(Status::no_equilibrium);
    if (!std::isfinite(rho)) return end(Status::stagnated);

    r_z = P_->r_z();
    P_->advance(rho, v_, it.x);  // x += rho v, r -= rho A v
    contact_rows_times_v();
    r_C_ -= rho * Av_C_;
    bool restart = close_gaps(it, rho, rho_gap);
    if (settings_.method == Method::gc1 || settings_.method == Method::gc2)  // at once
      restart |= release_tensile(it, tolerance) && settings_.method == Method::gc1;
    if (!regularized()) restart |= freeze_stick(it, g, rho);
    restart |= update_friction(it, g, phi);
    verdict = judge(it, g, phi, rho, tolerance);  // GC3: after eps_1
    verdict.restart |= restart;
    if (observer_) observer_->iterate(iterations_, it.x);
  }
  return end(Status::converged);
}

void ProjectedCG::begin(Iterate& it, const Vector& g, const Phi& phi) {
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i];
    if (problem_.increment.bilateral) it.contact[i] = 1;
    it.x[N] =
        it.contact[i] ? problem_.increment.gap[i] : std::min(it.x[N], problem_.increment.gap[i]);
    if (tangents_ == Tangents::stuck) it.x.segment(N + 1, problem_.tangents(i)).setZero();
    if (it.x[N] == problem_.increment.gap[i]) it.contact[i] = 1;
  }
  if (!regularized() && tangents_ == Tangents::sliding)
    for (Index i = 0; i < problem_.nodes(); ++i)
      stick_[i] = g[i] > 0 && tangential_norm(*problem_.system, i, it.x) == 0;
  recompute_residual(it);
  norm_ratio_ = 0;
  since_measured_ = 0;
  update_friction(it, g, phi);
}

/// r = F - Ax from scratch; update_friction has to follow.
void ProjectedCG::recompute_residual(const Iterate& it) {
  v_.noalias() = problem_.system->A * it.x;
  v_ = problem_.increment.F - v_;
  r_C_ = v_.tail(problem_.contact_dofs());
  P_->start(v_);
  v_.setZero();
}

/// <g phi'(x_T), v>: what <F - Ax, v> has more than <r, v>.
Real ProjectedCG::friction_part_along_v() const {
  Real sum = 0;
  for (Index c = 0; c < r_C_.size(); ++c)
    if (part_.free[c]) sum += (r_C_[c] - rf_C_[c]) * v_[problem_.interior() + c];
  return sum;
}

/// Holds again the released nodes that P r would drive into the obstacle, or against friction: they
/// saw the residual of the others, not their own force. The next release waits for a smaller
/// residual.
bool ProjectedCG::hold_inward(Iterate& it, const Vector& g, const Phi& phi) {
  bool held = false;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i];
    if (it.contact[i] || v_[N] <= 0 || it.x[N] < problem_.increment.gap[i]) continue;
    it.contact[i] = held = true;
  }
  if (!held) return false;
  partial_ /= 10;
  update_friction(it, g, phi);
  return true;
}

/// Smallest rho at which a free contact node reaches its gap.
Real ProjectedCG::step_to_gap(const Iterate& it) const {
  Real rho = infinity;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i];
    if (!it.contact[i] && v_[N] > 0)
      rho = std::min(rho, (problem_.increment.gap[i] - it.x[N]) / v_[N]);
  }
  return std::max(rho, 0.0);
}

bool ProjectedCG::close_gaps(Iterate& it, Real rho, Real rho_gap) {
  if (rho < rho_gap) return false;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i];
    if (it.contact[i] || v_[N] <= 0) continue;
    if (it.x[N] >= problem_.increment.gap[i] - 1e-15 * std::abs(problem_.increment.gap[i]) -
                       1e-15 * rho * v_[N]) {
      it.x[N] = problem_.increment.gap[i];
      it.contact[i] = 1;
    }
  }
  return true;
}

/// Violations of a face up to here, in norm_D, are left to the tolerance.
Real ProjectedCG::release_threshold(Real tolerance) const {
  if (settings_.stop_on_step > 0) return 0;
  return 0.1 * tolerance * problem_.increment.force_scale / std::sqrt(Real(problem_.nodes()));
}

/// Opens the nodes in contact on which the obstacle would have to pull by more than rounding and
/// the tolerance explain.
bool ProjectedCG::release_tensile(Iterate& it, Real tolerance) {
  if (problem_.increment.bilateral) return false;
  const Real threshold = release_threshold(tolerance);
  bool released = false;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index c = problem_.system->first[i] - problem_.interior();
    if (it.contact[i] && r_C_[c] < -threshold * std::sqrt(D_[problem_.system->first[i]])) {
      it.contact[i] = 0;
      released = true;
    }
  }
  return released;
}

/// x_C += dx, r_C -= A_CC dx; the interior follows in settle_displacements.
void ProjectedCG::displace(Iterate& it, Index c, Real dx) {
  it.x[problem_.interior() + c] += dx;
  dx_C_[c] += dx;
  const Index *row = problem_.system->A.outerIndexPtr(), *col = problem_.system->A.innerIndexPtr();
  const Real* a = problem_.system->A.valuePtr();
  const Index i = problem_.interior() + c;
  for (Index k = row[i + 1] - 1; k >= row[i] && col[k] >= problem_.interior(); --k)
    r_C_[col[k] - problem_.interior()] -= a[k] * dx;
}

void ProjectedCG::settle_displacements() {
  P_->move_contact(dx_C_);
  dx_C_.setZero();
}

/// d = D^{-1} beta
bool ProjectedCG::release_by_descent(Iterate& it, const Vector& g, Real tolerance) {
  const Real threshold = release_threshold(tolerance);
  d_C_.setZero();
  Real beta_d = 0;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i], c = N - problem_.interior(), t = problem_.tangents(i);
    if (it.contact[i] && !problem_.increment.bilateral &&
        r_C_[c] < -threshold * std::sqrt(D_[N])) {
      d_C_[c] = r_C_[c] / D_[N];
      beta_d += r_C_[c] * d_C_[c];
    }
    if (t == 0 || !stick_[i] || tangents_ == Tangents::stuck) continue;
    const auto r_T = r_C_.segment(c + 1, t);
    const Real excess = r_T.norm() - g[i];
    if (excess <= threshold * std::sqrt(D_[N + 1])) continue;
    d_C_.segment(c + 1, t) = excess / r_T.norm() / D_[N + 1] * r_T;
    beta_d += excess * excess / D_[N + 1];
  }
  if (beta_d == 0) return false;
  const Index *row = problem_.system->A.outerIndexPtr(), *col = problem_.system->A.innerIndexPtr();
  const Real* a = problem_.system->A.valuePtr();
  const Index interior = problem_.interior();
  Real dAd = 0;
  for (Index c = 0; c < d_C_.size(); ++c) {
    if (d_C_[c] == 0) continue;
    for (Index k = row[interior + c + 1] - 1; k >= row[interior + c] && col[k] >= interior; --k)
      dAd += d_C_[c] * a[k] * d_C_[col[k] - interior];
  }
  const Real rho = beta_d / dAd;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i], c = N - problem_.interior(), t = problem_.tangents(i);
    if (d_C_[c] != 0) it.contact[i] = 0;
    if (t > 0 && d_C_.segment(c + 1, t).squaredNorm() > 0) stick_[i] = 0;
  }
  for (Index c = 0; c < d_C_.size(); ++c)
    if (d_C_[c] != 0) displace(it, c, rho * d_C_[c]);
  settle_displacements();
  return true;
}

/// Holds at x_T = 0 the nodes that the step has turned round, where x_T = 0 minimizes J over x_T.
bool ProjectedCG::freeze_stick(Iterate& it, const Vector& g, Real rho) {
  if (tangents_ == Tangents::stuck) return false;
  bool frozen = false;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index T = problem_.system->first[i] + 1, t = problem_.tangents(i);
    if (t == 0 || stick_[i] || g[i] == 0) continue;
    auto x_T = it.x.segment(T, t);
    const auto v_T = v_.segment(T, t);
    static const Real kappa = getenv("KAPPA") ? atof(getenv("KAPPA")) : 0.1;
    const bool tiny = D_[T] * x_T.squaredNorm() <= kappa * kappa * P_->r_z();
    // came nearer to 0 along the step, and is closest to it, or past it
    const bool turned = x_T.dot(v_T) - rho * v_T.squaredNorm() < 0 && x_T.dot(v_T) >= -1e-12 * x_T.norm() * v_T.norm();
    if (!turned && !tiny) continue;
    Tangent r_0 = r_C_.segment(T - problem_.interior(), t);
    for (Index k = 0; k < t; ++k)
      for (Index l = 0; l < t; ++l) r_0[k] += problem_.system->A.coeff(T + k, T + l) * x_T[l];
    if (r_0.norm() > g[i]) continue;
    for (Index k = 0; k < t; ++k) displace(it, T - problem_.interior() + k, -x_T[k]);
    x_T.setZero();
    stick_[i] = 1;
    frozen = true;
  }
  if (frozen) settle_displacements();
  return frozen;
}

/// Norm of what the faces violate: tensile forces, and stick forces beyond g.
Real ProjectedCG::dual_violation(const Iterate& it, const Vector& g) const {
  Real sum = 0;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i], c = N - problem_.interior(),
                t = problem_.tangents(i);
    const Real r = std::min(r_C_[c], 0.0);
    if (it.contact[i] && !problem_.increment.bilateral) sum += r * r / D_[N];
    if (regularized() || tangents_ == Tangents::stuck || t == 0 || !stick_[i]) continue;
    const Real excess = std::max(r_C_.segment(c + 1, t).norm() - g[i], 0.0);
    sum += excess * excess / D_[N + 1];
  }
  return std::sqrt(sum);
}

/// r and J'' on the contact dofs, after x or the contact set has changed. True where a node of REG3
/// has crossed eps, so that J has another quadratic form from here on.
bool ProjectedCG::update_friction(const Iterate& it, const Vector& g, const Phi& phi) {
  bool crossed = false;
  rf_C_ = r_C_;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i], c = N - problem_.interior(),
                t = problem_.tangents(i);
    part_.free[c] = !it.contact[i];
    if (it.contact[i]) rf_C_[c] = 0;
    if (t == 0) continue;
    const bool held = tangents_ == Tangents::stuck || (!regularized() && stick_[i]);
    const Real x_T = it.x.segment(N + 1, t).norm();
    for (Index k = 1; k <= t; ++k) part_.free[c + k] = !held;
    if (held) {
      rf_C_.segment(c + 1, t).setZero();
    } else if (g[i] > 0) {
      auto r_T = rf_C_.segment(c + 1, t);
      if (x_T == 0 && phi.eps == 0)  // about to slide along its force
        r_T *= std::max(0.0, 1 - g[i] / r_T.norm());
      else
        r_T -= g[i] * phi.slope_over_t(x_T) * it.x.segment(N + 1, t);
      part_.hessian.segment(c + 1, t).setConstant(g[i] * phi.mean_curvature(x_T, t));
      // the piece of J: inside eps or outside; without eps, the sense of a single tangent
      const char sticking = phi.eps > 0 ? x_T <= phi.eps : t == 1 && it.x[N + 1] > 0;
      crossed = crossed || sticking != sticking_[i];
      sticking_[i] = sticking;
    } else {
      part_.hessian.segment(c + 1, t).setZero();
    }
  }
  P_->set_contact(rf_C_, part_);
  return crossed && settings_.reg == Regularization::polynomial && settings_.step == Step::exact;
}

/// The stopping test; GC3 releases contacts here, after partial convergence.
ProjectedCG::Verdict ProjectedCG::judge(Iterate& it, const Vector& g, const Phi& phi, Real rho,
                                        Real tolerance) {
  const bool by_step = settings_.stop_on_step > 0;
  const Real eps_0 = by_step ? settings_.stop_on_step : tolerance * problem_.increment.force_scale;
  const Real violation = by_step ? 0 : dual_violation(it, g);
  Real eps_1 = eps_0;
  if (settings_.method == Method::gc3) eps_1 = partial_ * eps_0;
  if (settings_.method == Method::gcx) eps_1 = violation;
  const Real measure = !by_step  ? free_norm_if_below(std::max(eps_0, eps_1))
                       : rho > 0 ? rho * v_.norm() / it.x.norm()
                                 : infinity;
  Verdict verdict;
  verdict.stop = measure <= eps_0 && std::hypot(measure, violation) <= eps_0;
  if (verdict.stop && !by_step) return verdict;
  const bool after_eps_1 = settings_.method == Method::gc3 || settings_.method == Method::gcx;
  if (!after_eps_1 || measure > eps_1) return verdict;
  const bool released = regularized() ? release_tensile(it, tolerance) : release_by_descent(it, g, tolerance);
  if (!released) return verdict;
  update_friction(it, g, phi);
  verdict.stop = false;
  verdict.restart = true;
  return verdict;
}

/// |r| on the free dofs, or infinity where <r, Pr> says that it cannot be below the bound.
Real ProjectedCG::free_norm_if_below(Real bound) {
  const Real r_z = std::sqrt(std::max(P_->r_z(), 0.0));
  if (norm_ratio_ * r_z > bound && ++since_measured_ < measure_every) return infinity;
  const Real norm = P_->free_norm();
  since_measured_ = 0;
  norm_ratio_ = r_z > 0 ? norm / r_z : 0;
  return norm;
}

void ProjectedCG::contact_rows_times_v() {
  const Index* row = problem_.system->A.outerIndexPtr();
  const Index* col = problem_.system->A.innerIndexPtr();
  const Real* a = problem_.system->A.valuePtr();
  for (Index c = 0; c < Av_C_.size(); ++c) {
    Real sum = 0;
    for (Index k = row[problem_.interior() + c]; k < row[problem_.interior() + c + 1]; ++k)
      sum += a[k] * v_[col[k]];
    Av_C_[c] = sum;
  }
}

}  // namespace frictioncg
