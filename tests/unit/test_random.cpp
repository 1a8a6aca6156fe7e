// Random scenes against the verifier: whatever is called converged must obey the unregularized
// laws, to ten times tol in units of the contact forces, and a scene that has an answer must be
// solved. RANDOM_SCENES and RANDOM_SEED in the environment choose how many, and which;
// RANDOM_VERBOSE names those that were not solved, and the layers that solved the others.
#include <gtest/gtest.h>

#include <iostream>
#include <map>

#include "core/solver.h"
#include "random_scene.h"
#include "verifier.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

struct Result {
  Status status;
  Layer layer;
  Real worst = 0;  ///< of the laws, by the verifier, where converged
};

Result judge(const Recipe& recipe, const Settings& settings) {
  const Scene s = make_scene(recipe);
  const bool needs_nodes = settings.method == Method::multigrid;
  const Posed system = s.system(needs_nodes ? mesh_nodes(s) : std::vector<Index>());
  const Solution a = solve(system.problem(), settings);
  Result r{a.status, a.layer};
  if (a.status == Status::converged)
    r.worst = verify(s, system.to_global(a.x), system.force_to_global(a.certificate.r)).worst();
  return r;
}

const char* const layer_name[] = {"none",     "linear", "newton",      "interior_point",
                                  "proximal", "limits", "fixed_point", "gcx",
                                  "gc",       "sorp",   "multigrid"};

/// How many of the scenes end how; fails for each one that is converged and wrong, or has an answer
/// and is not converged.
/// patience: a bound on the iterations, larger than the default, for scenes that have an answer.
/// change: of each recipe.
void run_scenes(
    const char* title, unsigned count, unsigned seed, Settings settings, Index patience = 0,
    Recipe (*change)(Recipe) = [](Recipe r) { return r; }) {
  const Real accuracy = 10 * settings.tol;
  std::map<Status, unsigned> ends;
  std::map<Layer, unsigned> layers;  // that solved
  const bool verbose = from_environment("RANDOM_VERBOSE", 0) != 0;
  for (unsigned k = 0; k < count; ++k) {
    const Recipe recipe = change(random_recipe(seed + k));
    settings.nbiter = recipe.has_solution() ? patience : 0;
    const Result result = judge(recipe, settings);
    ++ends[result.status];
    if (result.status == Status::converged) ++layers[result.layer];
    const auto wrong = [&](const Recipe& q) { return !(judge(q, settings).worst <= accuracy); };
    if (verbose && result.status != Status::converged && result.status != Status::no_equilibrium)
      std::cout << "  " << name_of(result.status) << ": " << recipe << std::endl;
    if (result.status != Status::converged && recipe.has_solution())
      ADD_FAILURE() << title << ": " << name_of(result.status) << " where there is an answer\n  "
                    << recipe;
    if (result.worst <= accuracy) continue;
    const Recipe small = shrink(recipe, wrong);
    const std::string file = "random_scene_" + std::to_string(recipe.seed) + ".txt";
    write(make_scene(small), file);
    ADD_FAILURE() << title << ": converged, but off by " << result.worst << "\n  " << recipe
                  << "\n  shrunk to " << small << "\n  off by " << judge(small, settings).worst
                  << ", written to " << file;
  }
  std::cout << title << ": " << count << " scenes from seed " << seed << ":";
  for (const auto& [status, n] : ends) std::cout << " " << name_of(status) << " " << n;
  if (verbose) {
    std::cout << "; converged by";
    for (const auto& [layer, n] : layers) std::cout << " " << layer_name[int(layer)] << " " << n;
  }
  std::cout << std::endl;
}

}  // namespace

TEST(RandomScenes, TheDefaultSolvesWhatHasAnAnswerAndObeysTheLaws) {
  run_scenes("default", from_environment("RANDOM_SCENES", 1000), from_environment("RANDOM_SEED", 1),
             Settings());
}

TEST(RandomScenes, CohesionAndCapsAreSolvedAndObeyed) {
  const unsigned count = from_environment("RANDOM_SCENES", 1000),
                 seed = from_environment("RANDOM_SEED", 1);
  run_scenes("bounds", count / 2, seed, Settings(), 0, with_bounds);
  for (const auto& [method, name] : {std::pair{Method::multigrid, "bounds, multigrid"},
                                     {Method::gc3, "bounds, GC3"},
                                     {Method::gcx, "bounds, GCX"},
                                     {Method::sorp, "bounds, SORP"}}) {
    Settings settings{method};
    if (method != Method::multigrid) settings.tol = 1e-7;
    run_scenes(name, count / 10, seed, settings, method == Method::sorp ? 300000 : 0, with_bounds);
  }
}

TEST(RandomScenes, TheIterativeMethodsSolveWhatHasAnAnswerAndObeyTheLaws) {
  const unsigned count = from_environment("RANDOM_SCENES", 1000) / 10,
                 seed = from_environment("RANDOM_SEED", 1);
  for (const auto& [method, name] :
       {std::pair{Method::gc3, "GC3"}, {Method::gcx, "GCX"}, {Method::sorp, "SORP"}}) {
    Settings settings{method};
    settings.tol = 1e-7;
    // SORP, too, arrives at nu = 0.4999, in time
    run_scenes(name, count, seed, settings, method == Method::sorp ? 300000 : 0);
  }
  Settings settings;
  settings.newton = false;
  run_scenes("on S", count, seed, settings);
}

TEST(RandomScenes, MultigridSolvesWhatTheDefaultSolvesNearlyAlwaysWithoutItsHelp) {
  const unsigned count = from_environment("RANDOM_SCENES", 1000) / 4,
                 seed = from_environment("RANDOM_SEED", 1);
  Settings settings{Method::multigrid};
  run_scenes("multigrid", count, seed, settings);
  unsigned of_default = 0, alone = 0;
  for (unsigned k = 0; k < count; ++k) {
    const Recipe recipe = random_recipe(seed + k);
    if (recipe.algebraic) continue;  // no coordinates: the condensed route answers
    const Status wanted = judge(recipe, Settings()).status;
    if (wanted != Status::converged && wanted != Status::no_equilibrium) continue;
    const Result result = judge(recipe, settings);
    ++of_default;
    EXPECT_EQ(result.status, wanted) << recipe;
    alone += result.layer == Layer::multigrid || result.layer == Layer::none;
  }
  EXPECT_GE(alone, 0.98 * of_default);
}

TEST(RandomScenes, ShrinkingKeepsTheFailureAndDropsTheRest) {
  Recipe r = random_recipe(7);
  r.algebraic = true;
  r.nodes = 37;
  r.gaps = true;
  const Recipe small = shrink(r, [](const Recipe& q) { return q.nodes >= 5; });
  EXPECT_EQ(small.nodes, 5);
  EXPECT_FALSE(small.gaps);
  EXPECT_FALSE(small.mu_varies);
}
