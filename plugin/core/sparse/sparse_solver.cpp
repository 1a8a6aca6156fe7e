#include "sparse/sparse_solver.h"

#include "condensed/interior_point.h"
#include "multigrid/faces.h"
#include "sparse/sparse_path.h"
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

Solution SparseSolver::solve(const ContactProblem& problem, const Settings& settings,
                             const Vector& x0, Observer* observer) {
  Solution s = go_on(problem, settings, x0, observer);
  const Index bound = bound_of(problem, settings);
  if (decided(s) || s.iterations >= bound) return s;
  return after(s, follow_path(problem, settings, bound - s.iterations, observer));
}

Solution SparseSolver::go_on(const ContactProblem& problem, const Settings& settings,
                             const Vector& x0, Observer* observer) {
  Solution s = newton_.solve(problem, settings, x0, observer, bounded);
  s.route = Route::sparse;
  if (s.layer == Layer::multigrid) s.layer = Layer::sparse_newton;
  answered_ = answered_ || s.status == Status::converged;
  return s;
}

Solution SparseSolver::follow_path(const ContactProblem& problem, const Settings& settings,
                                   Index max_steps, Observer* observer) {
  const System& system = *problem.system;
  CentralPath path(problem, std::make_unique<SparsePathMatrix>(system, *factor_),
                   problem.increment.F, system.weight, observer);
  Index steps = path.follow(max_steps);
  const auto from_its_end = [&](Index left) {
    Settings rest = settings;
    rest.nbiter = std::clamp<Index>(left, 1, from_path);
    newton_.forget();  // the end of the path has the faces
    return newton_.solve(problem, rest, steps > 0 ? path.x() : Vector(), observer);
  };
  answered_ = false;
  Solution s = from_its_end(max_steps - steps);
  const Index left = max_steps - steps - s.iterations;
  if (steps > 0 && left > 0 && !decided(s) && !is_rounding(s.certificate)) {
    const Index more = path.go_on(left);
    steps += more;
    if (more > 0) s = after(s, from_its_end(left - more));
  }
  answered_ = s.status == Status::converged;
  s.iterations += steps;
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
