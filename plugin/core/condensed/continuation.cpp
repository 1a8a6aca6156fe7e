#include "condensed/continuation.h"

#include <algorithm>

namespace frictioncg {

namespace {
constexpr Real first_step = 0.25;       ///< of the factor on mu
constexpr Real least_step = 1.0 / 256;  ///< where so small a step fails, the path ends
}  // namespace

Attempt by_continuation(const CondensedProblem& problem, Index max_steps) {
  Attempt a;
  if (problem.laws.increment.law != Law::coulomb) return a;
  ContactProblem laws = problem.laws;
  const CondensedProblem scaled{problem.S, problem.f, problem.D, laws, problem.springs};
  Real reached = 0, step = first_step;
  while (reached < 1 && step >= least_step && a.steps < max_steps) {
    const Real next = std::min(1.0, reached + step);
    laws.increment.mu = next * problem.laws.increment.mu;
    if (newton_from(a.x, scaled, max_steps, a)) {
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
