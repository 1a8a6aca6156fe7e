#include "gradient/bent_path.h"
#include "gradient/iterate.h"
#include "gradient/line_search.h"
#include "gradient/preconditioner.h"
#include "gradient/release_rule.h"
#include "gradient/stopping.h"
#include "gradient/tresca.h"

namespace frictioncg {

namespace {

/// A is not positive semi-definite where <Av,v>/<Dv,v> is below this; rounding of a rigid motion
/// leaves 1e-13 at most on the scenes of the tests.
constexpr Real indefinite = -1e-11;

/// A release leaves violations alone that are together below this share of eps_0.
constexpr Real unreleased = 0.1;

/// omega of (16) where the settings leave it open. GC1 to GC3 take the paper's 1. GCX has no 1/eps
/// in its matrix: on the block, 1.5 takes half of the iterations of 1.
constexpr Real papers_omega = 1, omega_of_faces = 1.5;

Real relaxation(const Settings& settings, const ReleaseRule& rule) {
  if (settings.omega > 0) return settings.omega;
  return rule.stick_is_a_face() ? omega_of_faces : papers_omega;
}

/// Problem 4 of (10): minimizes J_eps at given g over x_N <= gap by conjugate gradients projected
/// on the faces of the present contact.   sections 3 to 5
///
///   r = F - Ax - g phi'(x_T), 0 on held dofs               -J' of (11)
///   repeat
///     v = P r + gamma v, gamma of (12), P of (15)           P and v on the free dofs only
///     rho of (13) or (14), at most up to the first gap
///     x += rho v
///     nodes that reached their gap are held; restart
///     release of held nodes, as the rule of GC1, GC2, GC3 or GCX wants it; restart
///   until |r_free|^2 + |violation|^2 <= eps_0^2             in norm_D
///
/// gamma is cut off at 0, and a restart follows a node that crosses eps (REG3, exact step): J has
/// another quadratic form from there on.
class ProjectedCG final : public TrescaSolver {
 public:
  ProjectedCG(const ContactProblem& problem, const Settings& settings, Observer* observer)
      : problem_(problem),
        settings_(settings),
        max_iterations_(bound_of(problem, settings)),
        observer_(observer),
        stiffness_(tangential_stiffness(*problem.system)),
        rule_(settings, *problem.system),
        P_(make_preconditioner(*problem.system, settings.precon, relaxation(settings, rule_))),
        line_search_(*problem.system, settings.step, settings.stop_on_step == 0),
        it_(problem),
        v_(Vector::Zero(problem.dofs())) {}

  Outcome minimize(Vector& x, const Vector& g, Real eps, Tangents tangents, Real bound) override {
    Outcome outcome;
    it_.phi = regularized() ? Phi{settings_.reg, eps} : Phi{Regularization::polynomial, 0};
    it_.x.swap(x);
    Events events = begin(g, tangents, bound);  // r = F - Ax - g phi'(x_T)
    while (!events.stop && outcome.status == Status::converged) {
      if (iterations_ >= max_iterations_) {
        outcome.status = Status::max_iterations;
        break;
      }
      ++iterations_;
      const bool before = events.released && outcome.steps.total() == 0, restart = events.restart;
      Line line;
      Real rho = 0, rho_gap = infinity;
      outcome.status = direct(restart, line);  // (12), (15)
      if (outcome.status == Status::converged)
        outcome.status = search(line, rho, rho_gap);  // (13), (14)
      if (outcome.status == Status::converged) {
        events = advance(line, rho, rho_gap);  // x += rho v; new contact
        stop_or_release(events, rho);          // stop, or release
      }
      if (outcome.status == Status::not_positive_definite) outcome.negative = v_;
      events.released |= before;
      const StepLabel label = events.label(restart);
      outcome.steps.add(label);
      if (observer_) observer_->iterate(iterations_, label, it_.x);
    }
    it_.x.swap(x);
    return outcome;
  }

  bool regularized() const override { return !rule_.stick_is_a_face(); }

 private:
  /// What an iteration, or the start, has led to.
  struct Events {
    bool contact_hit = false, stick_frozen = false, released = false, crossed = false;
    bool expanded = false;
    bool restart = true;  ///< the direction of the next iteration
    bool stop = false;
    /// The one label of the iteration that led to it, along P r alone or not.
    StepLabel label(bool restarted) const {
      if (released) return StepLabel::release;
      if (expanded) return StepLabel::expansion;
      if (contact_hit) return StepLabel::contact_hit;
      if (stick_frozen) return StepLabel::stick_frozen;
      return restarted ? StepLabel::restart : StepLabel::conjugate;
    }
  };

  Events begin(const Vector& g, Tangents tangents, Real bound) {
    eps_0_ = by_step() ? settings_.stop_on_step : bound;
    norm_ = {};
    least_ = by_step() ? 0 : unreleased * bound / std::sqrt(Real(problem_.nodes()));
    it_.g = g;
    it_.faces.start(it_.x, g, tangents, rule_.stick_is_a_face());
    Vector r;
    problem_.system->multiply(it_.x, r);
    r = problem_.increment.F - r;
    it_.rows.start(r);
    P_->start(r);
    v_.setZero();
    Events events;
    if (rule_.at_once()) events.released = rule_.release(it_, least_);
    update_friction();
    stop_or_release(events, 0);
    events.restart = true;
    return events;
  }

  /// v = P r + gamma v, or P r alone: at a restart, where that is no descent, and where it would
  /// drive an open node at its gap into the obstacle. Stagnated where all is held: there is no way
  /// down.
  Status direct(bool restart, Line& line) {
    const auto set_direction = [&](Real gamma) {
      P_->direction(gamma, v_);
      line.r_v = P_->r_v(v_);
    };
    const Real gamma = restart || r_z_ <= 0 ? 0 : std::max(0.0, P_->dr_z() / r_z_);
    set_direction(gamma);
    if (gamma != 0 && line.r_v <= 0) set_direction(0);
    while (it_.faces.activate_blocked(it_.x, v_)) {
      update_friction();
      set_direction(0);
    }
    r_z_ = P_->r_z();
    return line.r_v > 0 ? Status::converged : Status::stagnated;
  }

  Status search(Line& line, Real& rho, Real& rho_gap) {
    line.vAv = P_->curvature(v_);
    if (line.vAv.A < indefinite * line.vAv.D) return Status::not_positive_definite;
    line.a = line.r_v + it_.friction_along(v_);
    rho_gap = it_.faces.step_to_gap(it_.x, v_);
    rho = line_search_(it_.phi, it_.g, it_.x, v_, line, rho_gap);
    return std::isfinite(rho) ? Status::converged : Status::stagnated;
  }

  Events advance(const Line& line, Real rho, Real rho_gap) {
    Events events;
    P_->advance(rho, v_, it_.x);  // x += rho v, r -= rho A v
    it_.rows.advance(rho, v_);
    if (rho >= rho_gap) events.contact_hit = it_.faces.close_gaps(it_.x, v_, rho);
    if (events.contact_hit && rule_.stick_is_a_face()) {
      const Real gained = follow_bent_path(it_, *P_, line_search_, v_, rho, line);
      events.expanded = gained > 0;
      rho += gained;
    }
    if (rule_.stick_is_a_face())
      events.stick_frozen =
          come_to_rest(it_, v_, rho, stiffness_, std::sqrt(std::max(P_->r_z(), 0.0)));
    it_.rows.settle(*P_);
    if (rule_.at_once()) events.released = rule_.release(it_, least_);
    events.crossed = update_friction();
    events.restart = events.contact_hit || events.stick_frozen || events.crossed ||
                     (events.released && rule_.restarts());
    return events;
  }

  /// The stopping test, and the release of what the faces violate: again where a release has left
  /// nothing to do on the free dofs.
  void stop_or_release(Events& events, Real rho) {
    for (Index k = 0; k <= problem_.nodes(); ++k) {
      const Real violation = by_step() ? 0 : it_.faces.violation(it_.rows.r(), it_.g);
      const Real eps_1 = rule_.threshold(eps_0_, violation);
      const Real left = left_after(rho, std::max(eps_0_, eps_1));
      events.stop = left <= eps_0_ && std::hypot(left, violation) <= eps_0_;
      if (left > eps_1 || (events.stop && !by_step())) return;
      if (!rule_.release(it_, least_)) return;
      it_.rows.settle(*P_);
      update_friction();
      events.released = true;
      events.restart |= rule_.restarts();
      events.stop = false;
      if (P_->r_z() > 0) return;
    }
  }

  /// To repeat the paper's tables |dx|/|x| is what is left.
  bool by_step() const { return settings_.stop_on_step > 0; }

  /// What is left to do after the step dx = rho v, against eps_0: the norm of the residual on the
  /// free dofs, by <r, P r>; or infinity where it is surely above `wanted`.
  Real left_after(Real rho, Real wanted) {
    if (by_step()) return rho > 0 ? rho * v_.norm() / it_.x.norm() : infinity;
    return norm_(std::sqrt(std::max(P_->r_z(), 0.0)), wanted, [&] { return P_->free_norm(); });
  }

  /// r on the contact dofs, J'' and the mask. True where J has another quadratic form from here on,
  /// which matters to the exact walk along REG3 and |x_T|.
  bool update_friction() {
    const bool crossed = it_.update_friction();
    P_->set_contact(it_.r, it_.part);
    return crossed && it_.phi.kind == Regularization::polynomial && settings_.step == Step::exact;
  }

  const ContactProblem& problem_;
  const Settings& settings_;
  const Index max_iterations_;
  Observer* const observer_;
  const Vector stiffness_;  ///< m, of A_TT
  ReleaseRule rule_;
  const std::unique_ptr<Preconditioner> P_;
  LineSearch line_search_;
  RareMeasure norm_;  ///< of the residual on the free dofs
  Real eps_0_ = 0;    ///< what may be left
  Iterate it_;
  Vector v_;              ///< n, the direction
  Real r_z_ = 0;          ///< <r, P r> of the last direction
  Real least_ = 0;        ///< violations of a face up to here are left to the tolerance
  Index iterations_ = 0;  ///< over all minimizations
};

}  // namespace

std::unique_ptr<TrescaSolver> make_tresca_solver(const ContactProblem& problem,
                                                 const Settings& settings, Observer* observer) {
  if (settings.method == Method::sorp) return make_sorp(problem, settings, observer);
  return std::make_unique<ProjectedCG>(problem, settings, observer);
}

}  // namespace frictioncg
