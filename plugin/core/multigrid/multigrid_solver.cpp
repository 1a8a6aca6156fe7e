#include "multigrid/multigrid_solver.h"

#include "clock.h"
#include "statics/equilibrium.h"
#include "statics/undetermined.h"
#include "multigrid/inexact_newton.h"
#include "statics/floating.h"
#include "threads.h"

namespace frictioncg {

namespace {

/// What takes more cycles is better left to another route.
constexpr Index most_iterations = 2000;
/// The route costs so many cycles as a rule, set-up included: the unit of `Allowance::cost`.
constexpr Real usual_iterations = 40;
/// Statics of more motions than so many costs more than cycles: it is asked where those do not
/// arrive.
constexpr Index few_motions = 60;

}  // namespace

MultigridSolver::MultigridSolver(SystemPtr system) : system_(std::move(system)) { set_up(); }

MultigridSolver::MultigridSolver(SystemPtr system, std::shared_ptr<Hierarchy> hierarchy)
    : system_(std::move(system)),
      hierarchy_(std::move(hierarchy)),
      motions_(floating_motions(*system_)) {}

void MultigridSolver::renew(SystemPtr system) {
  hierarchy_.reset();  // it may know the system
  system_ = std::move(system);
  set_up_ = false;
}

void MultigridSolver::set_up() {
  const double start = cpu_seconds();
  with_threads(system_->dofs(), [&] {
    side_by_side(2, [&](Index k) {
      if (k == 0)
        hierarchy_ = make_hierarchy(*system_);
      else
        motions_ = floating_motions(*system_);
    });
  });
  set_up_ = true;
  setup_ = cpu_seconds() - start;
}

void MultigridSolver::take(SystemPtr system) {
  system_ = std::move(system);
  motions_ = floating_motions(*system_);
}

Solution MultigridSolver::solve(const ContactProblem& problem, const Settings& settings,
                                const Vector& x0, Observer* observer, const Allowance& allowance) {
  Solution s;
  s.route = Route::multigrid;
  s.layer = system_->largest(problem.nodes()) == 0 ? Layer::linear : Layer::multigrid;
  s.levels = {hierarchy_->levels(), hierarchy_->operator_complexity(), hierarchy_->bytes()};
  s.times.factor = std::exchange(setup_, 0);
  double start = cpu_seconds();
  const bool many = motions_.cols() > few_motions;
  if (many || !shown_unheld(problem, s)) {
    iterate(problem, settings, x0, observer, allowance, s);
    if (many && s.status != Status::converged) shown_unheld(problem, s);
  }
  s.times.contact = cpu_seconds() - start;
  start = cpu_seconds();
  if (s.status == Status::converged && motions_.cols() > 0) {
    s.undetermined = left_free(motions_, problem, branches_of(problem, s.x, s.certificate));
    leave_least(problem, settings.tol, s);
  }
  s.times.certificate = cpu_seconds() - start;
  return s;
}

/// Whether statics proves that nothing holds the load.
bool MultigridSolver::shown_unheld(const ContactProblem& problem, Solution& s) const {
  const std::optional<Vector> motion = unheld_motion(motions_, problem);
  if (!motion) return false;
  s.status = Status::no_equilibrium;
  s.unheld_motion = *motion;
  s.x = Vector::Zero(problem.dofs());
  s.certificate = certify(problem, s.x);
  return true;
}

void MultigridSolver::iterate(const ContactProblem& problem, const Settings& settings,
                              const Vector& x0, Observer* observer, const Allowance& allowance,
                              Solution& s) {
  const Real affordable = allowance.cost * usual_iterations;
  InexactNewton newton(problem, *hierarchy_, observer, affordable, allowance.violation, s);
  const Index most = static_cast<Index>(std::min<Real>(affordable, most_iterations));
  const Index bound = std::min(settings.nbiter > 0 ? settings.nbiter : most, most);
  const Vector going_on = past_.next(*system_, problem.increment);
  const Start start = best_of(problem, x0, going_on);
  Branches faces;  // none: those of the start
  if (start.x.size() == 0)
    faces = stick_where_closed(problem.increment, last_);
  else if (!(past_.has_direction() && start.goes_on))
    faces = last_;
  with_threads(system_->dofs(),
               [&] { s.status = newton.solve(settings.tol, bound, start.x, start.b, faces); });
  if (s.status != Status::converged) {
    s.certificate = certify(problem, s.x);
    return;
  }
  last_ = newton.faces();
  past_.add(problem.increment, s.x);
}

/// Whichever start is nearest to the laws.
MultigridSolver::Start MultigridSolver::best_of(const ContactProblem& problem, const Vector& x0,
                                                const Vector& going_on) const {
  Start best;
  if (x0.size() == 0 && going_on.size() == 0) return best;
  Real least = certify(problem, Vector::Zero(system_->dofs())).residual;
  for (const Vector* x : {&x0, &going_on}) {
    if (x->size() == 0) continue;
    Certificate certificate = certify(problem, *x);
    if (!(certificate.residual < least)) continue;
    least = certificate.residual;
    best = {*x, std::move(certificate.r), x == &going_on};
  }
  return best;
}

void MultigridSolver::forget() {
  last_.clear();
  past_.forget();
}

}  // namespace frictioncg
