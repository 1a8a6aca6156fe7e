// That the iterative methods arrive on blocks in three dimensions that have an answer, and at what
// cost.
#include <gtest/gtest.h>

#include "block3d.h"
#include "core/solver.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// Ends and costs of one method over many solves.
struct Tally {
  unsigned missed = 0, stagnated = 0;
  unsigned above_3 = 0;  ///< of the iterations of GC3, where both arrive
};
using Tallies = std::map<Method, Tally>;

/// By all methods, where the default finds an answer, which is returned.
Vector solve_by_all(const ContactProblem& problem, Tallies& tallies) {
  const Solution exact = solve(problem, Settings());
  if (exact.status != Status::converged) return exact.x;
  Real of_gc3 = infinity;
  for (Method method : {Method::gc3, Method::gc1, Method::gc2, Method::gcx, Method::sorp}) {
    Settings settings{method};
    settings.nbiter = 5000;
    const Solution s = solve(problem, settings);
    const bool arrived = s.status == Status::converged;
    if (arrived && method == Method::gc3) of_gc3 = std::max<Index>(1, s.iterations);
    Tally& tally = tallies[method];
    tally.missed += !arrived;
    tally.stagnated += s.status == Status::stagnated;
    tally.above_3 += arrived && s.iterations > 3 * of_gc3;
  }
  return exact.x;
}

/// Pressed, then driven round a loop: 25 increments, each from the exact state before.
void run_history(unsigned seed, Tallies& tallies) {
  Block3d recipe = random_block3d(seed);
  recipe.driven = true;
  recipe.block.clamp_side = false;
  Scene s = make_scene(recipe);
  Posed posed = s.system();
  Vector u_old;
  for (int k = 1; k <= 25; ++k) {
    const Real angle = 0.25 * k;
    const Eigen::Vector3d drive(recipe.drive[0] * std::sin(angle),
                                recipe.drive[1] * (1 - std::cos(angle)),
                                recipe.drive[2] * std::min(1.0, 0.4 + 0.1 * k));
    drive_top(recipe, drive, s);
    posed.pose(s.b, u_old, s.laws());
    u_old = posed.to_global(solve_by_all(posed.problem(), tallies));
  }
}

}  // namespace

TEST(Arrival, GradientMethodsArriveOnBlocksInThreeDimensionsAndGcxCostsNoMoreThanThriceGc3) {
  Tallies tallies;
  for (unsigned seed = 1; seed <= 25; ++seed)
    solve_by_all(make_scene(random_block3d(seed)).system().problem(), tallies);
  run_history(1, tallies);  // 15 and 16 of its increments stalled
  for (Method m : {Method::gc1, Method::gc2, Method::gc3, Method::gcx})
    EXPECT_EQ(tallies[m].missed, 0u) << int(m);
  EXPECT_EQ(tallies[Method::gcx].above_3, 0u);
  EXPECT_EQ(tallies[Method::sorp].stagnated, 0u);
}
