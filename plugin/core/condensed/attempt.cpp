#include "condensed/attempt.h"

#include "model/proximal_springs.h"

namespace frictioncg {

namespace {

constexpr Index newton_steps = 40;  ///< where it arrives it takes 15; beyond 40 it cycles

/// The first springs are as stiff as D, a node on its own; the weakest are near the rounding of D.
constexpr Real first_springs = 1, weakest_springs = 1e-10;
/// Newton's method is tried without springs once they are as weak as this.
constexpr Real weak_springs = 1e-2;
/// Where springs as stiff as this do not help, nothing does.
constexpr Real strongest_springs = 100;
/// Bodies that were held took up to 150 steps.
constexpr Index most_newton_steps = 400;

}  // namespace

bool newton_from(const Vector& x, const CondensedProblem& problem, Index max_steps, Attempt& a,
                 const Branches& given) {
  SemismoothNewton newton(problem);
  if (x.size() > 0)
    newton.start_from(x);
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

Attempt by_proximal_points(const CondensedProblem& problem, Index max_steps) {
  Attempt a;
  max_steps = std::min(max_steps, most_newton_steps);
  CondensedProblem sprung = problem;
  ProximalSprings springs(first_springs, weakest_springs);
  while (a.steps < max_steps && springs.eps() <= strongest_springs) {
    sprung.springs = springs.eps();
    sprung.f = problem.f;
    if (a.x.size() > 0) sprung.f.array() += sprung.springs * problem.D.array() * a.x.array();
    if (newton_from(a.x, sprung, max_steps, a)) {
      if (springs.eps() <= weak_springs) a.solved = newton_from(a.x, problem, max_steps, a);
      if (a.solved) return a;
      springs.found();
    } else {
      springs.missed();
    }
  }
  return a;
}

}  // namespace frictioncg
