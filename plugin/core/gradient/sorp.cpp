#include "gradient/sorp.h"

#include <cmath>
#include <limits>

namespace frictioncg {

Sorp::Sorp(const ContactProblem& problem, const Settings& settings, Index max_iterations,
           Observer* observer)
    : problem_(problem),
      settings_(settings),
      max_iterations_(max_iterations),
      observer_(observer),
      D_(problem.system->D),
      omega_(settings.omega > 0 ? settings.omega : 1.8),
      stiffness_(problem.nodes()),
      r_(problem.dofs()) {
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index T = problem.system->first[i] + 1, t = problem.tangents(i);
    if (t == 1) stiffness_[i] = D_[T];
    if (t == 2) {
      const Real off = problem.system->A.coeff(T, T + 1), half = (D_[T] - D_[T + 1]) / 2;
      stiffness_[i] = (D_[T] + D_[T + 1]) / 2 + std::hypot(half, off);
    }
  }
}

Outcome Sorp::minimize(Iterate& it, const Vector& g, Real, Tangents tangents, Real tolerance) {
  const Index first_iteration = iterations_;
  const auto end = [&](Status s) { return Outcome{s, iterations_ - first_iteration}; };
  const Real bound = tolerance * problem_.increment.force_scale;
  Real ratio = 0;  // last measured violation over the change of its sweep
  Index since_measured = 0;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i];
    it.x[N] = problem_.increment.bilateral ? problem_.increment.gap[i]
                                           : std::min(it.x[N], problem_.increment.gap[i]);
    if (tangents == Tangents::stuck) it.x.segment(N + 1, problem_.tangents(i)).setZero();
  }
  bool done = violation(it.x, g, tangents) <= bound;
  while (!done) {
    if (iterations_ >= max_iterations_) return end(Status::max_iterations);
    ++iterations_;
    sweep(it.x, g, tangents);
    if (!std::isfinite(change_)) return end(Status::no_equilibrium);
    const Real change = std::sqrt(change_);
    if (settings_.stop_on_step > 0) {
      done = r_.norm() <= settings_.stop_on_step * it.x.norm();  // r_ holds dx here
    } else if (ratio * change <= bound || ++since_measured >= 20) {
      const Real measured = violation(it.x, g, tangents);
      ratio = change > 0 ? measured / change : 0;
      since_measured = 0;
      done = measured <= bound;
    }
    if (observer_) observer_->iterate(iterations_, it.x);
  }
  for (Index i = 0; i < problem_.nodes(); ++i)
    it.contact[i] = it.x[problem_.system->first[i]] >= problem_.increment.gap[i];
  return end(Status::converged);
}

Real Sorp::row_residual(const Vector& x, Index i) const {
  const Index* row = problem_.system->A.outerIndexPtr();
  const Index* col = problem_.system->A.innerIndexPtr();
  const Real* a = problem_.system->A.valuePtr();
  Real r = problem_.increment.F[i];
  for (Index k = row[i]; k < row[i + 1]; ++k) r -= a[k] * x[col[k]];
  return r;
}

void Sorp::update(Vector& x, Index i, Real value) {
  const Real dx = value - x[i];
  x[i] = value;
  r_[i] = dx;
  change_ += D_[i] * dx * dx;
}

void Sorp::sweep(Vector& x, const Vector& g, Tangents tangents) {
  change_ = 0;
  for (Index i = 0; i < problem_.interior(); ++i)
    update(x, i, x[i] + omega_ * row_residual(x, i) / D_[i]);
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i];
    if (!problem_.increment.bilateral)
      update(x, N, std::min(x[N] + omega_ * row_residual(x, N) / D_[N], problem_.increment.gap[i]));
    if (tangents == Tangents::sliding && problem_.tangents(i) > 0) relax_tangents(x, i, g[i]);
  }
}

/// x_T := soft threshold at omega g / a of x_T + omega r_T / a: fixed where r_T is in g d|x_T|.
void Sorp::relax_tangents(Vector& x, Index node, Real g) {
  const Index T = problem_.system->first[node] + 1, t = problem_.tangents(node);
  const Real step = omega_ / stiffness_[node];
  Real y[2], norm = 0;
  for (Index k = 0; k < t; ++k) {
    y[k] = x[T + k] + step * row_residual(x, T + k);
    norm = std::hypot(norm, y[k]);
  }
  const Real shrink = norm > step * g ? 1 - step * g / norm : 0;
  for (Index k = 0; k < t; ++k) update(x, T + k, shrink * y[k]);
}

/// What is left of the optimality conditions at given g, in norm_D.
Real Sorp::violation(const Vector& x, const Vector& g, Tangents tangents) {
  r_.noalias() = problem_.system->A * x;
  r_ = problem_.increment.F - r_;
  Real sum =
      (r_.head(problem_.interior()).array().square() / D_.head(problem_.interior()).array()).sum();
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i], t = problem_.tangents(i);
    const NodeLaw law{Law::tresca, problem_.increment.bilateral, g[i]};
    const Real normal = law.normal_residual(D_[N] * (problem_.increment.gap[i] - x[N]), r_[N]);
    sum += normal * normal / D_[N];
    if (t == 0 || tangents == Tangents::stuck) continue;
    sum += friction_residual(r_.segment(N + 1, t), x.segment(N + 1, t), stiffness_[i], g[i])
               .squaredNorm() /
           stiffness_[i];
  }
  return std::sqrt(sum);
}

}  // namespace frictioncg
