#include "condensed/continuation.h"

#include <algorithm>
#include <cmath>

namespace frictioncg {

namespace {

constexpr Index newton_steps = 40;
constexpr Real first_springs = 1;
constexpr Real last_springs = 1e-10;
constexpr Real weak_springs = 1e-2;  ///< from here on Newton is tried without them
constexpr Real first_ratio = 0.1;    ///< from springs to springs
constexpr Real later_ratio = 0.3;    ///< the same, once Newton has failed
constexpr Real stiffer = 10;
constexpr Index proximal_steps = 400;  ///< of Newton, over all points
constexpr Real most_springs = 100;     ///< where even these do not help, nothing does
constexpr Real first_friction_step = 0.25;
constexpr Real last_friction_step = 1.0 / 512;

/// Newton from x, or from stick where there is none; counts its steps.
bool solve_from(const Vector& x, const CondensedProblem& problem, Index max_steps, Attempt& a) {
  SemismoothNewton newton(problem);
  if (x.size() > 0)
    newton.start_from(x, problem.residual(x));
  else
    newton.start_from_stick();
  const Index bound = std::min(newton_steps, max_steps - a.steps);
  const bool solved = newton.solve(bound) == SemismoothNewton::Outcome::converged;
  a.steps += newton.steps();
  if (!solved) return false;
  a.x = newton.x();
  a.branches = newton.branches();
  a.undetermined = newton.undetermined();
  return true;
}

}  // namespace

Attempt by_proximal_points(const CondensedProblem& problem, Index max_steps) {
  Attempt a;
  max_steps = std::min(max_steps, proximal_steps);
  CondensedProblem held = problem;
  held.springs = first_springs;
  Real ratio = first_ratio;
  while (a.steps < max_steps && held.springs <= most_springs) {
    held.f = problem.f;
    if (a.x.size() > 0) held.f.array() += held.springs * problem.D.array() * a.x.array();
    if (solve_from(a.x, held, max_steps, a)) {
      if (held.springs <= weak_springs) a.solved = solve_from(a.x, problem, max_steps, a);
      if (a.solved) return a;
      held.springs = std::max(last_springs, ratio * held.springs);
    } else {
      ratio = later_ratio;
      held.springs *= stiffer;
    }
  }
  return a;
}

Attempt by_growing_friction(const CondensedProblem& problem, Index max_steps) {
  Attempt a;
  if (problem.laws.increment.law != Law::coulomb) return a;
  ContactProblem laws = problem.laws;
  const CondensedProblem scaled{problem.S, problem.f, problem.D, laws, problem.springs};
  Real reached = 0, step = first_friction_step;
  while (reached < 1 && step > last_friction_step && a.steps < max_steps) {
    const Real next = std::min(1.0, reached + step);
    laws.increment.mu = next * problem.laws.increment.mu;
    if (solve_from(a.x, scaled, max_steps, a)) {
      reached = next;
      step *= 2;
    } else {
      step /= 2;
    }
  }
  a.solved = reached == 1;
  return a;
}

}  // namespace frictioncg
