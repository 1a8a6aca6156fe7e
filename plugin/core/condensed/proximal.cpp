#include "condensed/proximal.h"

#include "model/proximal_springs.h"

namespace frictioncg {

namespace {

/// The first springs are as stiff as D, a node on its own; the weakest are near the rounding of D.
constexpr Real first_springs = 1, weakest_springs = 1e-10;
/// Newton's method is tried without springs once they are as weak as this.
constexpr Real weak_springs = 1e-2;
/// Where springs as stiff as this do not help, nothing does.
constexpr Real strongest_springs = 100;
/// Bodies that were held took up to 150 steps.
constexpr Index most_steps = 400;

}  // namespace

Attempt by_proximal_points(const CondensedProblem& problem, Index max_steps) {
  Attempt a;
  max_steps = std::min(max_steps, most_steps);
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
