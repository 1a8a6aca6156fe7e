#include "gradient/fixed_point.h"

#include "gradient/anderson.h"

namespace frictioncg {

namespace {

/// eps starts at this share of max|x|: it costs 0.46 eps/max|x| of error in energy, which is below
/// every tol. A smaller eps takes more iterations.
constexpr Real first_relative_eps = 1e-8;
/// It is no smaller a share of the displacements that F/diag(A) gives.
constexpr Real least_motion = 1e-6;
/// The first minimizations need no smaller residual: sticking contact tells mu F_N to a percent.
constexpr Real first_tolerance = 1e-2;
/// The last minimization may leave this share of tol: the certificate measures two other things.
constexpr Real share = 1.0 / 3;
/// A minimization solves to this share of the mismatch |G(g) - g|: a pass reduces the mismatch to
/// 0.15 to 0.45 of it. The share is halved, down to the least, where passes do not help: forces may
/// be less precise than the residual.
constexpr Real first_precision = 0.1, least_precision = 1e-4;
/// A pass cuts the tolerance of the minimization by no more than this: g may be far off yet.
constexpr Real largest_cut = 1e-3;
/// A mismatch or a certificate counts as better below this share of the best one.
constexpr Real better = 0.5;
/// g is settled where its mismatch is below this share of its tolerance: the certificate decides
/// about the rest.
constexpr Real settled = 0.9;
/// eps follows the displacement once the body has slid so many times as far as it seemed.
constexpr Real slid_on = 2;
/// The error is about proportional to eps, which aims at this share of tol.
constexpr Real eps_margin = 0.3;

class FixedPoint {
 public:
  FixedPoint(const ContactProblem& problem, const Settings& settings, TrescaSolver& tresca)
      : problem_(problem),
        settings_(settings),
        tresca_(tresca),
        coulomb_(problem.increment.law == Law::coulomb),
        g_(Vector::Zero(problem.nodes())) {}

  Solution solve(const Vector& x0) {
    start(x0);
    if (!coulomb_) inner_ = finest();
    Real last = infinity;
    while (solution_.status == Status::converged) {
      minimize(Tangents::sliding, inner_ * solution_.certificate.scale);
      ++solution_.passes;
      solution_.certificate = certify(problem_, solution_.x);
      if (solution_.certificate.residual <= settings_.tol) {
        solution_.status = Status::converged;
        break;
      }
      if (solution_.status != Status::converged || !improve(last)) break;
    }
    if (!coulomb_) solution_.passes = 0;
    return std::move(solution_);
  }

 private:
  /// The first g comes from sticking contact: it exists wherever contact alone holds the body, and
  /// its displacement is the unit of eps.
  void start(const Vector& x0) {
    const bool friction = problem_.increment.law != Law::frictionless;
    solution_.x = x0.size() > 0 ? x0 : Vector(Vector::Zero(problem_.dofs()));
    solution_.certificate = certify(problem_, solution_.x);
    if (x0.size() == 0 && friction && settings_.stop_on_step == 0) {
      const Certificate& c = solution_.certificate;  // of rest: its residual is the load
      minimize(Tangents::stuck, first_tolerance * c.scale * std::max(1.0, c.residual));
      solution_.certificate = certify(problem_, solution_.x);
    }
    g_ = sliding_limits();
    if (friction && tresca_.regularized())
      solution_.eps =
          settings_.regeps > 0 ? settings_.regeps : relative_eps_ * displacement_scale();
  }

  void minimize(Tangents tangents, Real bound) {
    const Real eps = tangents == Tangents::stuck ? 1 : solution_.eps;  // stuck: no friction acts
    const Outcome o = tresca_.minimize(solution_.x, g_, eps, tangents, bound);
    solution_.steps += o.steps;
    solution_.iterations += o.iterations();
    solution_.status = o.status;
    solution_.negative = o.negative;
  }

  /// What can be done about a certificate above tol after a minimization that met its bound, in
  /// this order: a better g, a smaller bound, the same again where the recurrence of r had drifted,
  /// a smaller eps. False where nothing is left.
  bool improve(Real& last) {
    if (coulomb_ && update_sliding_limit()) return solution_.status == Status::converged;
    if (inner_ > finest()) {
      inner_ = finest();
      return true;
    }
    if (solution_.certificate.residual < better * last) {
      last = solution_.certificate.residual;
      return true;
    }
    return sharpen_regularization();
  }

  /// g := G(g), accelerated. False where g is settled to the tolerance.
  bool update_sliding_limit() {
    const Real mismatch = measure_image();
    if (mismatch <= settled * finest() && inner_ <= finest()) return false;
    const bool learnt = mismatch >= inner_;
    judge_progress(std::max(mismatch, inner_));  // a pass tells g no better than it was solved
    inner_ = std::min(inner_, std::max({precision_ * mismatch, largest_cut * inner_, finest()}));
    if (solution_.status != Status::converged) return true;
    step_towards_image(learnt);
    if (settings_.regeps == 0 && solution_.eps > 0) {
      const Real eps = relative_eps_ * displacement_scale();
      if (eps > slid_on * solution_.eps)
        solution_.eps = eps;  // the body slides farther than it seemed
    }
    return true;
  }

  /// G(g), the limits that the answer at g has; returns |G(g) - g| in norm_D over the scale.
  Real measure_image() {
    image_ = sliding_limits();
    Real sum = 0;
    for (Index i = 0; i < problem_.nodes(); ++i) {
      if (problem_.tangents(i) == 0) continue;
      const Real d = image_[i] - g_[i];
      sum += d * d / problem_.system->weight[problem_.system->first[i] + 1];
    }
    return std::sqrt(sum) / solution_.certificate.scale;
  }

  /// Damping where acceleration has not helped for long; diverged where damping has not either.
  void judge_progress(Real mismatch) {
    if (mismatch < better * best_) {
      best_ = mismatch;
      since_best_ = 0;
      return;
    }
    precision_ = std::max(precision_ / 2, least_precision);
    if (++since_best_ <= tresca_.patience()) return;
    if (damped_) {
      solution_.status = Status::fixed_point_diverged;
      return;
    }
    damped_ = true;
    best_ = mismatch;
    since_best_ = -3 * tresca_.patience();  // damping is slow: it gets four times as long
  }

  /// learnt: the mismatch is one of g, not of the minimization; else it would mislead Anderson.
  void step_towards_image(bool learnt) {
    if (!learnt) {
      g_ = image_;
      anderson_.forget();
    } else if (damped_) {
      g_ = 0.5 * (g_ + image_);
    } else {
      g_ = anderson_.next(g_, image_).cwiseMax(0);
    }
  }

  /// Where everything else is settled, what keeps the certificate above tol is eps. False where eps
  /// is the user's, or has come to rounding.
  bool sharpen_regularization() {
    if (solution_.eps == 0) {
      solution_.status = Status::stagnated;
      return false;
    }
    const Certificate& c = solution_.certificate;
    const Real factor =
        eps_margin * std::min(1.0, std::max(settings_.tol, c.attainable) / c.residual);
    const Real least = epsilon * displacement_scale();
    if (settings_.regeps > 0 || factor * solution_.eps < least) {
      solution_.status = Status::regularized;
      return false;
    }
    solution_.eps *= factor;
    relative_eps_ *= factor;
    return true;
  }

  /// The last inner tolerance: less than tol, and no less than rounding allows.
  Real finest() const { return std::max(share * settings_.tol, solution_.certificate.attainable); }

  /// What moves, or a share of what the load makes of single nodes: where the stuck answer is that
  /// of before, what moves is rounding.
  Real displacement_scale() const {
    const Vector &F = problem_.increment.F, &D = problem_.system->D;
    const Real alone = (F.cwiseAbs().array() / D.array()).maxCoeff();
    return std::max(solution_.x.lpNorm<Eigen::Infinity>(), least_motion * alone) +
           std::numeric_limits<Real>::min();
  }

  /// The sliding limits at the present x; r_N = 0 where the node is open: what rounding leaves of
  /// it is no pressure, however large mu. Nodes whose cohesion keeps coming and going take a part l
  /// of it, l = proj_[0,1](l + (r_N - closing)/c).
  Vector sliding_limits() const {
    const System& system = *problem_.system;
    Vector g(problem_.nodes());
    for (Index i = 0; i < problem_.nodes(); ++i) {
      const Index N = system.first[i];
      const Real closing = problem_.closing(i, solution_.x);
      const NodeLaw law = law_of(problem_.increment, i);
      const Real r_N = solution_.certificate.r[N];
      g[i] = law.limit(closing, r_N);
      if (!damped_ || !law.coheres()) continue;
      const Real rubs = law.mu * std::max(r_N, 0.0);
      const Real part = std::clamp((g_[i] - rubs + r_N - closing) / law.c, 0.0, 1.0);
      g[i] = std::min(part * law.c + rubs, law.cap);
    }
    return g;
  }

  const ContactProblem& problem_;
  const Settings& settings_;
  TrescaSolver& tresca_;
  const bool coulomb_;
  Solution solution_;
  Vector g_;      ///< m [force]
  Vector image_;  ///< m, G(g)
  Anderson anderson_;
  Real relative_eps_ = first_relative_eps;  ///< over the displacement scale, where eps is ours
  Real inner_ = first_tolerance;  ///< bound of the next minimization, over the certificate's scale
  Real precision_ = first_precision;  ///< a minimization solves to this share of the mismatch of g
  Real best_ = infinity;              ///< least mismatch |G(g) - g| so far, over the scale
  Index since_best_ = 0;
  bool damped_ = false;
};

}  // namespace

Solution fixed_point(const ContactProblem& problem, const Settings& settings, TrescaSolver& tresca,
                     const Vector& x0) {
  return FixedPoint(problem, settings, tresca).solve(x0);
}

}  // namespace frictioncg
