#include "sparse/sparse_solver.h"

#include "condensed/interior_point.h"
#include "multigrid/faces.h"
#include "statics/undetermined.h"

namespace frictioncg {

namespace {

/// Newton's method takes up to 17 cycles, on 4 to 10 factors, where it settles, of the 40 that
/// multigrid takes as a rule.
constexpr Allowance bounded{0.5, lifts};
constexpr Index from_path = 40;  ///< steps, from the end of the central path: it takes 2 to 10

}  // namespace

void SparseSolver::renew(const SystemPtr& system) {
  factor_->renew(system);
  newton_.take(system);
}

Solution SparseSolver::solve(const Request& request) {
  Solution s = go_on(request);
  const Index left = request.bound() - s.iterations;
  return decided(s) || left <= 0 ? s : after(s, follow_path(request, left));
}

Solution SparseSolver::go_on(const Request& request) {
  const auto& [problem, settings, x0, observer] = request;
  Solution s = newton_.solve(problem, settings, x0, observer, bounded);
  s.route = Route::sparse;
  if (s.layer == Layer::multigrid) s.layer = Layer::sparse_newton;
  answered_ = answered_ || s.status == Status::converged;
  return s;
}

Solution SparseSolver::follow_path(const Request& request, Index max_steps) {
  const ContactProblem& problem = request.problem;
  const System& system = *problem.system;
  CentralPath path(problem, std::make_unique<SparsePathMatrix>(system, *factor_),
                   problem.increment.F, system.weight, request.observer);
  Index steps = path.follow(max_steps - 1);  // one is left for Newton's method
  const auto from_its_end = [&](Index left) {
    Settings rest = request.settings;
    rest.nbiter = std::clamp<Index>(left, 1, from_path);
    newton_.forget();  // the end of the path has the faces
    return newton_.solve(problem, rest, steps > 0 ? path.x() : Vector(), request.observer);
  };
  answered_ = false;
  Solution s = from_its_end(max_steps - steps);
  const Index left = max_steps - steps - s.iterations;
  if (steps > 0 && left > 0 && !decided(s) && !is_rounding(s.certificate)) {
    const Index more = path.go_on(left - 1);
    steps += more;
    if (more > 0) s = after(s, from_its_end(left - more));
  }
  answered_ = s.status == Status::converged;
  s.iterations += steps;
  if (s.status == Status::max_iterations && s.iterations < max_steps)
    s.status = Status::stagnated;  // by the bound on what follows the path
  s.route = Route::sparse;
  s.layer = Layer::sparse_interior_point;
  return s;
}

/// Open nodes and slip are free, no friction holds them. Mostly Newton's last factor tells.
bool SparseSolver::is_definite_at(const ContactProblem& problem, const Solution& s) {
  Faces faces(problem);
  faces.start_from(branches_of(problem, s.x, s.certificate));
  if (!factor_->is_of(faces.fixed())) factor_->truncate(faces.fixed(), {}, {});
  return factor_->definite();
}

}  // namespace frictioncg
