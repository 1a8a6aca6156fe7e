#include "gradient/fixed_point.h"

#include <cmath>
#include <limits>

namespace frictioncg {

namespace {
constexpr Real first_relative_eps = 1e-8;  ///< eps over max|x|: energy error 5e-9, see regeps
constexpr Real first_tolerance = 1e-2;
constexpr Real least_precision = 1e-4;
constexpr Index patience = 15;  ///< passes without halving the mismatch
}  // namespace

FixedPoint::FixedPoint(const ContactProblem& problem, const Settings& settings,
                       TrescaSolver& tresca)
    : problem_(problem),
      settings_(settings),
      tresca_(tresca),
      it_{Vector::Zero(problem.dofs()), std::vector<char>(problem.nodes(), 0)},
      g_(Vector::Zero(problem.nodes())),
      relative_eps_(first_relative_eps),
      best_(std::numeric_limits<Real>::infinity()) {}

Solution FixedPoint::solve(const Vector& x0) {
  const bool coulomb = problem_.increment.law == Law::coulomb;
  inner_ = coulomb ? first_tolerance : settings_.tol / 3;
  start(x0);
  Real last = std::numeric_limits<Real>::infinity();
  while (solution_.status == Status::converged) {
    solution_.status = pass();
    solution_.certificate = certify(problem_, it_.x);
    if (solution_.certificate.residual <= settings_.tol) {
      solution_.status = Status::converged;
      break;
    }
    if (solution_.status != Status::converged) break;
    if (coulomb && update_sliding_limit()) continue;
    if (inner_ > settings_.tol / 3) {
      inner_ = settings_.tol / 3;
      continue;
    }
    if (solution_.certificate.residual < 0.5 * last) {  // the recurrence of r had drifted
      last = solution_.certificate.residual;
      continue;
    }
    if (!sharpen_regularization()) break;
  }
  if (!coulomb) solution_.passes = 0;
  solution_.x = it_.x;
  solution_.state = classify(problem_, it_.x, solution_.certificate);
  return solution_;
}

/// The first g comes from sticking contact: it exists wherever contact alone holds the body, and
/// its displacement is the unit of eps.
void FixedPoint::start(const Vector& x0) {
  if (x0.size() > 0) {
    it_.x = x0;
  } else if (problem_.increment.law != Law::frictionless && settings_.stop_on_step == 0) {
    const Outcome o = tresca_.minimize(it_, g_, 1, Tangents::stuck, first_tolerance);
    solution_.iterations += o.iterations;
    if (o.status != Status::converged) solution_.status = o.status;
  }
  solution_.certificate = certify(problem_, it_.x);
  for (Index i = 0; i < problem_.nodes(); ++i)
    g_[i] = law_of(problem_.increment, i).limit(solution_.certificate.r[problem_.system->first[i]]);
  if (problem_.increment.law != Law::frictionless && tresca_.regularized())
    solution_.eps = settings_.regeps > 0 ? settings_.regeps : relative_eps_ * displacement_scale();
}

Status FixedPoint::pass() {
  const Outcome o = tresca_.minimize(it_, g_, solution_.eps, Tangents::sliding, inner_);
  solution_.iterations += o.iterations;
  ++solution_.passes;
  return o.status;
}

/// g := G(g) = mu max(r_N, 0), accelerated. False where g is settled to the tolerance.
bool FixedPoint::update_sliding_limit() {
  const Vector& r = solution_.certificate.r;
  Vector image(problem_.nodes());
  Real sum = 0;
  for (Index i = 0; i < problem_.nodes(); ++i) {
    const Index N = problem_.system->first[i];
    image[i] = law_of(problem_.increment, i).limit(r[N]);
    const Real d = image[i] - g_[i];
    if (problem_.tangents(i) > 0) sum += d * d / problem_.system->D[N + 1];
  }
  const Real mismatch = std::sqrt(sum) / problem_.increment.force_scale;
  if (mismatch <= 0.3 * settings_.tol && inner_ <= settings_.tol / 3) return false;

  const Real inner_before = inner_;
  const Real known = std::max(mismatch, inner_);  // a pass tells g no better than it was solved
  if (known < 0.5 * best_) {
    best_ = known;
    since_best_ = 0;
  } else {
    precision_ = std::max(precision_ / 2, least_precision);
    ++since_best_;
  }
  inner_ = std::min(inner_, std::max({precision_ * mismatch, 1e-3 * inner_, settings_.tol / 3}));
  if (since_best_ > patience) {
    if (damped_) {
      solution_.status = Status::fixed_point_diverged;
      return true;
    }
    damped_ = true;
    best_ = mismatch;
    since_best_ = -3 * patience;
  }
  if (mismatch < inner_before) {  // nothing learnt
    g_ = image;
    anderson_ = Anderson();
  } else if (damped_) {
    g_ = 0.5 * (g_ + image);
  } else {
    g_ = anderson_.next(g_, image).cwiseMax(0);
  }
  if (settings_.regeps == 0 && solution_.eps > 0) {
    const Real eps = relative_eps_ * displacement_scale();
    if (eps > 2 * solution_.eps) solution_.eps = eps;  // the body slides farther than it seemed
  }
  return true;
}

/// Where everything else is settled, what keeps the certificate above tol is eps. False where eps
/// is the user's, or has come to rounding.
bool FixedPoint::sharpen_regularization() {
  if (solution_.eps == 0) {
    solution_.status = Status::stagnated;
    return false;
  }
  const Real factor = std::min(0.3, 0.3 * settings_.tol / solution_.certificate.residual);
  const Real least = std::numeric_limits<Real>::epsilon() * displacement_scale();
  if (settings_.regeps > 0 || factor * solution_.eps < least) {
    solution_.status = Status::regularized;
    return false;
  }
  solution_.eps *= factor;
  relative_eps_ *= factor;
  return true;
}

Real FixedPoint::displacement_scale() const {
  const Real moved = it_.x.lpNorm<Eigen::Infinity>();
  if (moved > 0) return moved;
  return (problem_.increment.F.cwiseAbs().array() / problem_.system->D.array()).maxCoeff() + 1e-300;
}

}  // namespace frictioncg
