#include "gradient/iterate.h"
#include "gradient/stopping.h"
#include "gradient/tresca.h"
#include "model/contact_problem.h"

namespace frictioncg {

namespace {

/// The paper's optima are 1.58 to 1.96, scene by scene; 1.8 is best for its first example.
constexpr Real usual_omega = 1.8;

/// Successive over-relaxation with projection, the peer of the paper's tables: each dof in turn to
/// the minimizer of J along it, over-relaxed by omega, normals projected on x_N <= gap, tangents
/// thresholded at g. Not regularized.
class Sorp final : public TrescaSolver {
 public:
  Sorp(const ContactProblem& problem, const Settings& settings, Observer* observer)
      : problem_(at_given_limit(problem)),
        settings_(settings),
        max_iterations_(bound_of(problem, settings)),
        observer_(observer),
        D_(problem.system->D),
        omega_(settings.omega > 0 ? settings.omega : usual_omega),
        stiffness_(tangential_stiffness(*problem.system)),
        residual_(problem.dofs()) {}

  /// Stagnated where the sweeps leave the range of numbers: nothing is proved by that.
  Outcome minimize(Vector& x, const Vector& g, Real, Tangents tangents, Real bound) override {
    Outcome outcome;
    problem_.increment.g = g;
    ActiveSet(problem_).start(x, g, tangents, false);
    violation_ = {};
    bool done = violation(x, tangents) <= bound;
    while (!done && outcome.status == Status::converged) {
      if (iterations_ >= max_iterations_) {
        outcome.status = Status::max_iterations;
        break;
      }
      ++iterations_;
      const Change change = sweep(x, tangents);
      outcome.steps.add(StepLabel::sweep);
      if (!std::isfinite(change.energy)) outcome.status = Status::stagnated;
      done = settled(x, tangents, bound, change);
      if (observer_) observer_->iterate(iterations_, StepLabel::sweep, x);
    }
    return outcome;
  }

  bool regularized() const override { return false; }

 private:
  struct Change {
    Real energy = 0;  ///< sum of a_ii dx_i^2
    Real square = 0;  ///< sum of dx_i^2
  };

  static ContactProblem at_given_limit(ContactProblem problem) {
    problem.increment.law = Law::tresca;
    return problem;
  }

  Change sweep(Vector& x, Tangents tangents) const {
    Change change;
    for (Index i = 0; i < problem_.interior(); ++i)
      update(x, i, x[i] + omega_ * row_residual(x, i) / D_[i], change);
    for (Index i = 0; i < problem_.nodes(); ++i) {
      const Index N = problem_.system->first[i];
      const Real gap = problem_.increment.gap[i];
      if (!problem_.increment.bilateral)
        update(x, N, std::min(x[N] + omega_ * row_residual(x, N) / D_[N], gap), change);
      if (tangents == Tangents::sliding && problem_.tangents(i) > 0) relax_tangents(x, i, change);
    }
    return change;
  }

  void update(Vector& x, Index i, Real value, Change& change) const {
    const Real dx = value - x[i];
    x[i] = value;
    change.energy += D_[i] * dx * dx;
    change.square += dx * dx;
  }

  /// x_T := soft threshold at omega g / a of x_T + omega r_T / a: fixed where r_T is in g d|x_T|.
  void relax_tangents(Vector& x, Index node, Change& change) const {
    const Index T = problem_.system->first[node] + 1, t = problem_.tangents(node);
    const Real step = omega_ / stiffness_[node], g = problem_.increment.g[node];
    Tangent y(t);
    for (Index k = 0; k < t; ++k) y[k] = x[T + k] + step * row_residual(x, T + k);
    const Real norm = y.norm(), shrink = norm > step * g ? 1 - step * g / norm : 0;
    for (Index k = 0; k < t; ++k) update(x, T + k, shrink * y[k], change);
  }

  Real row_residual(const Vector& x, Index i) const {
    return problem_.increment.F[i] - row_product(*problem_.system, i, x);
  }

  /// What is left of the optimality conditions at given g, in norm_D.
  Real violation(const Vector& x, Tangents tangents) {
    const Vector& w = problem_.system->weight;
    const Index interior = problem_.interior();
    problem_.system->multiply(x, residual_);
    residual_ = problem_.increment.F - residual_;
    const Real equilibrium =
        (residual_.head(interior).array().square() / w.head(interior).array()).sum();
    const Violation v = frictioncg::violation(problem_, w, x, residual_);
    return std::sqrt(equilibrium + v.normal + (tangents == Tangents::sliding ? v.friction : 0));
  }

  bool settled(const Vector& x, Tangents tangents, Real bound, const Change& change) {
    if (settings_.stop_on_step > 0)
      return std::sqrt(change.square) <= settings_.stop_on_step * x.norm();
    return violation_(std::sqrt(change.energy), bound, [&] { return violation(x, tangents); }) <=
           bound;
  }

  ContactProblem problem_;  ///< at the limit of the minimization
  const Settings& settings_;
  const Index max_iterations_;
  Observer* const observer_;
  const Vector& D_;
  const Real omega_;
  const Vector stiffness_;  ///< m, of A_TT
  Vector residual_;         ///< n, of the last measurement
  RareMeasure violation_;   ///< by the change of a sweep
  Index iterations_ = 0;    ///< over all minimizations
};

}  // namespace

std::unique_ptr<TrescaSolver> make_sorp(const ContactProblem& problem, const Settings& settings,
                                        Observer* observer) {
  return std::make_unique<Sorp>(problem, settings, observer);
}

}  // namespace frictioncg
