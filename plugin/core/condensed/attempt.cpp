#include "condensed/attempt.h"

namespace frictioncg {

namespace {

constexpr Index newton_steps = 40;  ///< where it arrives it takes 15; beyond 40 it cycles

}  // namespace

bool newton_from(const Vector& x, const CondensedProblem& problem, Index max_steps, Attempt& a,
                 const Branches& given) {
  SemismoothNewton newton(problem);
  if (x.size() > 0)
    newton.start_from(x, problem.residual(x));
  else if (!given.empty())
    newton.start_from(given);
  else
    newton.start_from_stick();
  const Index bound = std::min(newton_steps, max_steps - a.steps);
  const bool solved = newton.solve(bound) == SemismoothNewton::Outcome::converged;
  a.steps += newton.steps();
  if (!solved) {
    if (a.steps >= max_steps) a.status = Status::max_iterations;
    return false;
  }
  a.x = newton.x();
  a.branches = newton.branches();
  a.undetermined = newton.undetermined();
  a.positive = newton.positive();
  return true;
}

}  // namespace frictioncg
