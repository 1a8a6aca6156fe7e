#include "condensed/proximal.h"

#include <algorithm>

namespace frictioncg {

namespace {

constexpr Real first_springs = 1;    ///< eps: a node on its own
constexpr Real weak_springs = 1e-2;  ///< from here on Newton is tried without them
constexpr Real weakest_springs = 1e-10;
constexpr Real strongest_springs = 100;  ///< where even these do not help, nothing does
constexpr Real weaker = 0.1;             ///< from point to point
constexpr Real warily_weaker = 0.3;      ///< the same, once a point was not found
constexpr Real stronger = 10;
constexpr Index most_steps = 400;  ///< bodies that were held took up to 150

}  // namespace

Attempt by_proximal_points(const CondensedProblem& problem, Index max_steps) {
  Attempt a;
  max_steps = std::min(max_steps, most_steps);
  CondensedProblem sprung = problem;
  sprung.springs = first_springs;
  Real ratio = weaker;
  while (a.steps < max_steps && sprung.springs <= strongest_springs) {
    sprung.f = problem.f;
    if (a.x.size() > 0) sprung.f.array() += sprung.springs * problem.D.array() * a.x.array();
    if (newton_from(a.x, sprung, max_steps, a)) {
      if (sprung.springs <= weak_springs) a.solved = newton_from(a.x, problem, max_steps, a);
      if (a.solved) return a;
      sprung.springs = std::max(weakest_springs, ratio * sprung.springs);
    } else {
      ratio = warily_weaker;
      sprung.springs *= stronger;
    }
  }
  return a;
}

}  // namespace frictioncg
