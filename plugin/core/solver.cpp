#include "solver.h"

#include "answer.h"
#include "condensed/condensed.h"
#include "gradient/fixed_point.h"
#include "model/validate.h"
#include "multigrid/multigrid_solver.h"
#include "sparse/sparse_solver.h"
#include "statics/equilibrium.h"
#include "statics/undetermined.h"

namespace frictioncg {

namespace {

/// Flops of a dense factor from which on another ordering of A is looked at.
constexpr double worth_an_ordering = 1e8;

/// Of a sparse factor, over the entries of A: strips of up to ten layers of elements have less.
constexpr double few_flops = 60;

/// Where the central path on sparse factors costs so many times what multigrid is estimated at, as
/// on P1 plates, multigrid may take a share of that before it: of those that are lifted or hang it
/// solves most, in 0.1 to 0.5 of the path's time, and no forces tell which. P2 plates are at 14, of
/// which it solves few: they are left as soon as forces show that they are lifted.
constexpr double far_dearer = 18, worth_a_try = 0.4;

/// Of a sparse factor, up to which a central path, of some thirty, comes to the aid of the
/// condensed route.
constexpr double path_flops = 1e10;

/// A gradient method that comes to the aid of the condensed route is nearer to the laws after so
/// many iterations, or gives up: on hard random scenes it is so after 0.25 to 0.5 of those that it
/// takes, and never where friction does not hold the load.
constexpr Index patience = 5000;

/// Where no factor can be had, the alternative to multigrid is a gradient method: multigrid may
/// then cost so many times what it does as a rule, which is more than it ever does.
constexpr double only_gradients = 1e6;

bool arrives(const Solution& s) { return decided(s) || s.certificate.residual <= at_rounding; }

/// Newton's method goes on from limits that change by less than this share; after so many it is
/// not asked.
constexpr Real near_limits = 0.1;
constexpr int most_limits = 15;

/// What bodies buckle by until something holds them, over what they have moved before: beyond,
/// displacements are not small.
constexpr Real farthest = 1000;

/// Steps p from x until something touches that does not yet.
Real step_to_contact(const ContactProblem& problem, const Vector& x, const Vector& p) {
  constexpr Real touch = 1e-9;
  const Real little = touch * x.lpNorm<Eigen::Infinity>();
  Real step = infinity;
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = problem.system->first[i];
    const Real way = problem.increment.gap[i] - x[N];
    if (way > little && p[N] > 0) step = std::min(step, way / p[N]);
  }
  return step;
}

/// s has taken what t, after it, has.
void count(Solution& s, const Solution& t) {
  s.iterations = t.iterations;
  s.steps = t.steps;
  s.times = t.times;
}

/// t, made after s did not arrive, takes its place where it decides or is nearer to the laws; what
/// both took counts. Returns how t ended.
Status replace_if_better(Solution& s, Solution t) {
  const Status status = t.status;
  t = after(s, std::move(t));
  if (t.negative.size() == 0) t.negative = s.negative;
  if (!decided(t) && !(t.certificate.residual < s.certificate.residual)) {
    count(s, t);
    s.negative = t.negative;
    return status;
  }
  if (!decided(t)) t.status = s.status;
  s = std::move(t);
  return status;
}

/// With the method that stands in for the condensed route, without a factor: not regularized
/// either, unless the settings ask for it.
Request without_factor(Request request) {
  request.settings.method = request.settings.newton ? Method::gcx : Method::gc3;
  return request;
}

/// Method auto, unless a regularized answer is asked for: multigrid where a factor does not fit.
bool may_replace_a_factor(const Settings& settings) {
  return settings.method == Method::automatic && settings.newton;
}

}  // namespace

/// Unless the settings name a method: a factorization serves every load and law that follows, and
/// the laws on the contact dofs alone are then exact and cheap; where it costs more than multigrid
/// takes for all of it, multigrid.
Plan make_plan(const ContactProblem& problem, const Settings& settings) {
  Plan plan;
  plan.route = condenses(settings)                    ? Route::condensed
               : settings.method == Method::multigrid ? Route::multigrid
                                                      : Route::iterative;
  const bool chooses = may_replace_a_factor(settings);
  if (chooses || settings.method == Method::multigrid) plan.costs = estimate_costs(*problem.system);
  if (chooses) {
    const double worth = worth_of_factor(*problem.system, plan.costs);
    if (worth * plan.costs.multigrid < plan.costs.condensed) plan.route = Route::multigrid;
  }
  plan.law = problem.nodes() > 0 ? problem.increment.law : Law::frictionless;
  plan.regularization = plan.law != Law::frictionless && smooths_friction(settings);
  return plan;
}

Solver::Solver(SystemPtr system) : system_(std::move(system)) { validate(*system_); }
Solver::~Solver() = default;

void Solver::renew(SystemPtr system) {
  validate(*system);
  const bool dofs = same_dofs(*system_, *system), pattern = same_pattern(*system_, *system);
  system_ = std::move(system);
  floating_.reset();
  poor_ = dofs && poor_;
  factored_ = indefinite_ = false;
  memory_needed_ = 0;
  if (!pattern) sparse_.reset();
  if (sparse_) sparse_->renew(system_);
  if (!dofs) condensed_.reset();
  if (condensed_) condensed_->renew(system_, pattern);
  if (!dofs || poor_) multigrid_.reset();
  if (multigrid_) multigrid_->renew(system_);
}

Solution Solver::solve(const Increment& increment, const Settings& settings, const Vector& x0,
                       Observer* observer) {
  validate(settings);
  validate(increment, *system_);
  validate_start(x0, *system_);
  const ContactProblem problem{system_, increment};
  return answer(
      problem, settings, [&] { return floating(); },
      [&] {
        const Request request{problem, settings, x0, observer};
        return or_as_held_before(by_route(request), request);
      });
}

/// s, or where contact lets go of what it held at the start of the increment, the answer that the
/// limits of stick lead to: of several a path of small steps leads to the one that holds, and
/// Newton's steps, in which nodes open and slip at once, pass by it. At given limits there is one
/// field; limits that fall from those of stick meet their own first where most is held.
///   g_0 = infinity,  g_1 = G(x(g_0)),  g_{k+1} = (g_k + G(x(g_k)))/2,  until Newton's method from
///   x(g_k) holds as well
Solution Solver::or_as_held_before(Solution s, const Request& request) {
  const ContactProblem& problem = request.problem;
  const bool by_newton = request.settings.newton && s.route != Route::iterative;
  if (!by_newton || problem.increment.law != Law::coulomb) return s;
  if (!(s.certificate.residual <= request.settings.tol)) return s;
  const auto bodies = let_go(problem, s);
  if (bodies.empty()) return s;
  const Vector lost = limits_at(problem, s);
  ContactProblem given = problem;
  given.increment.law = Law::tresca;
  given.increment.g = limits_of_stick(problem);
  Vector& g = given.increment.g;
  Vector x;
  const auto ask = [&](const ContactProblem& what) {
    const Request rest{what, what_remains(request, s).settings, x, request.observer};
    Solution t = after(s, by_route(rest));
    count(s, t);
    return t;
  };
  const auto may_ask = [&] { return what_remains(request, s).settings.nbiter > 0; };
  const auto holds = [&](const Solution& t) {
    return t.certificate.residual <= request.settings.tol &&
           hold_more(bodies, limits_at(problem, t), lost);
  };
  for (int k = 0; k < most_limits && may_ask(); ++k) {
    const Solution t = ask(given);
    if (!holds(t)) break;
    const Vector limits = limits_at(problem, t);
    const bool near = (limits - g).lpNorm<1>() < near_limits * limits.lpNorm<1>();
    x = t.x;
    g = k == 0 ? limits : Vector((g + limits) / 2);
    if (!near || !may_ask()) continue;
    const Solution held = ask(problem);
    if (holds(held)) return held;
  }
  return s;
}

/// The route of the plan; where it is not open, or does not arrive, another one.
Solution Solver::by_route(const Request& request) {
  const Settings& settings = request.settings;
  const Plan plan = make_plan(request.problem, settings);
  costs_ = plan.costs;
  multigrid_failed_ = path_tried_ = false;
  if (plan.route == Route::iterative) return by_gradients(request);
  const bool may_choose = may_replace_a_factor(settings);
  if (plan.route == Route::condensed) {
    if (may_choose && !condense(request) && !indefinite_) return by_multigrid(request);
    return by_condensation(request);
  }
  // that sparse factors come first shows once A is ordered
  const bool has_others = (poor_ || factored_) && settings.memory >= memory_needed_;
  if (may_choose && (has_others || sparse_comes_first(settings)))
    return (this->*after_multigrid(settings))(request);
  if (may_choose && sparse_ && sparse_->has_answered() && lay_out_sparse_factor(settings))
    return or_by(&Solver::by_multigrid, sparse_->go_on(request), request);
  return by_multigrid(request);
}

/// The condensed route where its factor fits; where it does not arrive, or does not fit, the same
/// laws on A.
Solution Solver::by_condensation(const Request& request) {
  if (!condense(request)) return by_gradients(without_factor(request));
  const auto path = [&](Index max_steps) -> std::optional<Solution> {
    if (max_steps <= 0 || !path_is_cheaper_on_A(request.settings)) return std::nullopt;
    path_tried_ = true;
    return sparse_->follow_path(request, max_steps);
  };
  Solution s = condensed_->solve(request, path);
  if (request.settings.newton) try_on_A(request, s);
  if (request.observer) request.observer->iterate(s.iterations, StepLabel::newton, s.x);
  return s;
}

/// Where the condensed route ends at rounding, no method comes nearer, but the load may still be
/// shown to have no answer. Where it fails short of it, the central path on A: of slender bodies S
/// has few digits. Then stick as a face on A itself: it needs no factor, which a nearly singular A
/// spoils. They take what the condensed route has left of the bound on the iterations.
void Solver::try_on_A(const Request& request, Solution& s) {
  if (decided(s)) return;
  const bool at_laws =
      s.certificate.residual <= request.settings.tol || may_be_rounding(s.certificate);
  if (at_laws && s.status == Status::not_positive_definite) {
    if (request.settings.buckles) buckle(request, s);
    return;
  }
  const Request path = what_remains(request, s);
  if (!is_rounding(s.certificate) && !path_tried_ && path.settings.nbiter > 0 &&
      lay_out_sparse_factor(path.settings) && sparse_->flops() <= path_flops) {
    Solution t = sparse_->follow_path(path, path.settings.nbiter);
    if (t.status == Status::converged && !sparse_->is_definite_at(path.problem, t))
      condensed_->look_for_negative_energy(path.problem, t);
    replace_if_better(s, std::move(t));
    if (decided(s)) return;
  }
  if (is_rounding(s.certificate)) return decide_on_equilibrium(request.problem, s);
  const Request rest = what_remains(without_factor(request), s);
  if (rest.settings.nbiter <= 0) return;
  Request some = rest;
  some.settings.nbiter = std::min(rest.settings.nbiter, patience);
  Solution t = by_gradients(some);
  Request more = what_remains(rest, t);
  if (t.status == Status::max_iterations && more.settings.nbiter > 0) {
    more.x0 = t.x;
    if (t.certificate.residual < s.certificate.residual)
      t = after(t, by_gradients(more));
    else
      t.status = Status::stagnated;  // the script's bound is not what ends it
  }
  const Status last = replace_if_better(s, std::move(t));
  if (!decided(s) && last == Status::not_positive_definite) s.status = last;
}

/// From a field at which the laws hold, but where bodies have not buckled, to the first contact on
/// the way down, and on from there: first the way that the load pushes, then the other one. Where
/// it pushes neither way, rounding would choose.
void Solver::buckle(const Request& request, Solution& s) {
  constexpr Real by_rounding = 1e-9;  // of F.p, over what it is summed of
  const ContactProblem& problem = request.problem;
  const Vector x = s.x, p = s.negative *
                            (x.lpNorm<Eigen::Infinity>() / s.negative.lpNorm<Eigen::Infinity>());
  const Vector work = problem.increment.F.cwiseProduct(p);
  const Real push = work.sum();
  if (std::abs(push) <= by_rounding * work.lpNorm<1>()) return;
  for (const Real way : {std::copysign(1., push), -std::copysign(1., push)}) {
    const Real step = step_to_contact(problem, x, way * p);
    Request rest = what_remains(without_factor(request), s);
    if (!(step < farthest) || rest.settings.nbiter <= 0) continue;
    rest.x0 = x + step * way * p;
    Solution t = after(s, by_gradients(rest));
    const bool at_laws = t.status == Status::converged || may_be_rounding(t.certificate);
    if (at_laws) condensed_->look_for_negative_energy(problem, t);
    if (at_laws && t.status != Status::not_positive_definite) {
      s = std::move(t);
      return;
    }
    count(s, t);
  }
}

/// The paper's methods: the fixed point on the sliding limit, and at each limit the method of the
/// settings.
Solution Solver::by_gradients(const Request& request) {
  const auto& [problem, settings, x0, observer] = request;
  const auto tresca = make_tresca_solver(problem, settings, observer);
  Solution s = fixed_point(problem, settings, *tresca, x0);
  s.layer = settings.method == Method::sorp  ? Layer::sorp
            : settings.method == Method::gcx ? Layer::gcx
                                             : Layer::gc;
  decide_on_equilibrium(problem, s);
  // The rigid motions that neither A nor the laws determine are named, and taken out of the answer;
  // where the system knows no candidates for them they are not looked for.
  if (s.certificate.residual > settings.tol) return s;
  s.undetermined = left_free(floating(), problem, branches_of(problem, s.x, s.certificate));
  leave_least(problem, settings.tol, s);
  return s;
}

const DenseMatrix& Solver::floating() {
  if (!floating_) floating_ = floating_motions(*system_);
  return *floating_;
}

/// J without a bound at the present sliding limit says nothing about Coulomb's law, and a stall
/// nothing about the load. Rigid motions do: no_equilibrium where one of them is a proof, and
/// nowhere else.
void Solver::decide_on_equilibrium(const ContactProblem& problem, Solution& s) {
  const bool open = s.status == Status::stagnated || s.status == Status::fixed_point_diverged ||
                    s.status == Status::max_iterations;
  if (!open) return;
  const auto motion = unheld_motion(floating(), problem);
  s.unheld_motion = motion.value_or(Vector());
  if (motion) s.status = Status::no_equilibrium;
}

/// Multigrid; where it does not arrive short of rounding, or has no coordinates to build on, the
/// route that is the cheapest of the others and what follows it.
Solution Solver::by_multigrid(const Request& request) {
  const auto& [problem, settings, x0, observer] = request;
  Request rest = request;
  rest.settings.method = Method::automatic;
  if (!multigrid_ || !multigrid_->is_set_up()) {
    if (observer) observer->begin(Work::hierarchy, seconds_of_hierarchy(*system_));
    if (multigrid_)
      multigrid_->set_up();
    else
      multigrid_ = std::make_unique<MultigridSolver>(system_);
  }
  if (!multigrid_->has_hierarchy()) return by_condensation(rest);
  Solution s = multigrid_->solve(problem, settings, x0, observer, allowance(settings));
  multigrid_failed_ = !arrives(s);
  const Way next = multigrid_failed_ ? after_multigrid(settings) : nullptr;
  poor_ = s.status != Status::max_iterations && next == &Solver::by_condensation;
  return or_by(next, std::move(s), rest);
}

/// Sparse factors of A: along the central path at once where Newton's method by multigrid has just
/// failed. Where they do not arrive, do not fit, or meet negative energy, the condensed route.
Solution Solver::by_sparse_factors(const Request& request) {
  if (!lay_out_sparse_factor(request.settings)) return by_condensation(request);
  path_tried_ = true;
  Solution s =
      multigrid_failed_ ? sparse_->follow_path(request, request.bound()) : sparse_->solve(request);
  return or_by(&Solver::by_condensation, std::move(s), request);
}

/// Whether there is one that fits.
bool Solver::lay_out_sparse_factor(const Settings& settings) {
  if (!sparse_) sparse_ = std::make_unique<SparseSolver>(system_);
  return sparse_->laid_out() && sparse_->bytes() <= settings.memory;
}

/// Whether Newton's method on sparse factors costs no more than by multigrid.
bool Solver::sparse_comes_first(const Settings& settings) {
  return costs_.sparse_first && lay_out_sparse_factor(settings) &&
         sparse_->flops() <= few_flops * double(system_->entries().nonZeros());
}

/// Sparse factors do for slender bodies, unless contact dofs are few; and where Newton's method by
/// multigrid has just failed, the central path is likely to be needed.
Solver::Way Solver::after_multigrid(const Settings& settings) {
  const bool sparse =
      std::isfinite(costs_.sparse) || (multigrid_failed_ && path_is_cheaper_on_A(settings));
  return sparse ? &Solver::by_sparse_factors : &Solver::by_condensation;
}

/// Whether a sparse factor of A is cheaper than a dense one of S, and fits.
bool Solver::path_is_cheaper_on_A(const Settings& settings) {
  const double dense = std::pow(double(system_->contact_dofs()), 3) / 3;
  return dense >= worth_an_ordering && lay_out_sparse_factor(settings) && sparse_->flops() < dense;
}

/// s, or where it decides nothing short of rounding, what the next route and those after it find
/// with what it has left of the bound on the iterations. Where A has negative energy beside an
/// answer, the condensed route shows it.
Solution Solver::or_by(Way next, Solution s, const Request& request) {
  const auto& [problem, settings, x0, observer] = request;
  if (arrives(s)) {
    const bool doubtful = s.route == Route::sparse && s.certificate.residual <= settings.tol;
    if (!doubtful || sparse_->is_definite_at(problem, s)) return s;
    return after(s, by_condensation({problem, settings, {}, observer}));
  }
  const Request rest = what_remains(request, s);
  const Status last =
      rest.settings.nbiter > 0 ? replace_if_better(s, (this->*next)(rest)) : Status::max_iterations;
  if (!decided(s)) s.status = last;  // it says why, not the route that gave way
  return s;
}

/// What the cheaper of the routes after it costs, over multigrid as a rule: infinite where the
/// latter is named.
Allowance Solver::allowance(const Settings& settings) const {
  if (settings.method != Method::automatic) return {};
  if (indefinite_ || settings.memory < memory_needed_) return {only_gradients};
  const double dense = costs_.condensed / costs_.multigrid;
  const double path = costs_.path / costs_.multigrid;
  if (path < far_dearer) return {std::min(dense, path), lifts};
  return {std::min(dense, worth_a_try * path)};
}

/// Whether the condensed route is open: factors A where that was not done, and fits now.
bool Solver::condense(const Request& request) {
  const Settings& settings = request.settings;
  if (settings.memory >= memory_needed_ && !factored_ && !indefinite_) {
    if (request.observer)
      request.observer->begin(Work::factorization, estimate_costs(*system_).condensed);
    if (!condensed_) condensed_ = std::make_unique<CondensedSolver>(system_);
    const Elimination::Outcome outcome = condensed_->factor(settings.memory);
    memory_needed_ = condensed_->elimination().memory_needed();
    factored_ = outcome == Elimination::Outcome::done;
    indefinite_ = outcome == Elimination::Outcome::not_positive_definite;
    if (!factored_) condensed_.reset();
  }
  if (settings.memory >= memory_needed_) return factored_;
  if (settings.method != Method::condensed) return false;
  const char* const condensed = "method=\"condensed\" needs ";
  const char* const otherwise = ", or leave the choice to method=\"auto\"";
  if (!std::isfinite(memory_needed_))
    refuse(condensed, "a factor of more than 2^31 entries, which CHOLMOD cannot index; take ",
           "method=\"GCX\"", otherwise);
  refuse(condensed, "at least ", memory_needed_ / 1e9,
         " GB for its factor and the dense matrices on ", system_->contact_dofs(),
         " contact dofs, more than memory = ", settings.memory / 1e9, " GB; raise memory",
         otherwise);
}

Solution solve(const ContactProblem& problem, const Settings& settings, const Vector& x0,
               Observer* observer) {
  return Solver(problem.system).solve(problem.increment, settings, x0, observer);
}

}  // namespace frictioncg
