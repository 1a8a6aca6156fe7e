// How often each iterative method arrives on blocks in three dimensions that have an answer, and at
// what cost. A long run: --gtest_also_run_disabled_tests --gtest_filter='*Arrival*';
// ARRIVAL_BLOCKS, ARRIVAL_HISTORIES and ARRIVAL_SEED in the environment choose how many, and which.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iomanip>
#include <iostream>

#include "block3d.h"
#include "core/solver.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

unsigned from_environment(const char* name, unsigned otherwise) {
  const char* value = std::getenv(name);
  return value ? static_cast<unsigned>(std::strtoul(value, nullptr, 10)) : otherwise;
}

constexpr Method methods[] = {Method::gc1, Method::gc2, Method::gc3, Method::gcx, Method::sorp};
constexpr const char* names[] = {"GC1", "GC2", "GC3", "GCX", "SORP"};
constexpr int method_count = 5;

/// Ends and costs of one method over many solves.
struct Tally {
  unsigned arrived = 0, missed = 0;
  double iterations = 0;
  double worst_ratio = 0;  ///< iterations over GC3's, where both arrive
  unsigned above_3 = 0;
  std::vector<unsigned> ends = std::vector<unsigned>(7, 0);
};

class Table {
 public:
  void add(const std::array<Solution, method_count>& s, const std::string& what, bool verbose) {
    for (int m = 0; m < method_count; ++m) {
      Tally& t = tally_[m];
      const bool arrived = s[m].status == Status::converged;
      ++(arrived ? t.arrived : t.missed);
      ++t.ends[int(s[m].status)];
      t.iterations += s[m].iterations;
      if (verbose && methods[m] == Method::gcx && !arrived)
        std::cout << "GCX ends with status " << int(s[m].status) << ", residual "
                  << s[m].certificate.residual << ", " << s[m].iterations << " iterations: " << what
                  << std::endl;
      if (!arrived || s[2].status != Status::converged) continue;
      const double ratio = s[m].iterations / std::max(1.0, double(s[2].iterations));
      if (ratio > 3) ++t.above_3;
      if (verbose && methods[m] == Method::gcx && ratio > 3)
        std::cout << "GCX " << s[m].iterations << ", GC3 " << s[2].iterations << ": " << what
                  << std::endl;
      t.worst_ratio = std::max(t.worst_ratio, ratio);
    }
  }
  void print(const char* title) const {
    std::cout << title << "\n  method  arrives  misses  mean iterations  worst over GC3  above 3 "
              << " max_iter stagn no_eq not_pd diverged regularized\n";
    for (int m = 0; m < method_count; ++m) {
      const Tally& t = tally_[m];
      std::cout << "  " << std::setw(6) << names[m] << std::setw(9) << t.arrived << std::setw(8)
                << t.missed << std::setw(17) << t.iterations / (t.arrived + t.missed)
                << std::setw(16) << t.worst_ratio << std::setw(9) << t.above_3;
      for (int e = 1; e < 7; ++e) std::cout << std::setw(8) << t.ends[e];
      std::cout << "\n";
    }
  }
  const Tally& of(Method m) const {
    for (int k = 0; k < method_count; ++k)
      if (methods[k] == m) return tally_[k];
    throw std::logic_error("no such method");
  }

 private:
  Tally tally_[method_count];
};

template <class Problem>
std::array<Solution, method_count> solve_by_all(const Problem& problem) {
  std::array<Solution, method_count> s;
  for (int m = 0; m < method_count; ++m) {
    Settings settings;
    settings.method = methods[m];
    settings.tol = 1e-8;
    settings.nbiter = 5000;
    s[m] = solve(problem, settings);
  }
  return s;
}

void run_blocks(unsigned count, unsigned seed, bool verbose, Table& table) {
  for (unsigned k = 0; k < count; ++k) {
    const Block3d recipe = random_block3d(seed + k);
    const Posed posed = make_scene(recipe).system();
    if (solve(posed.problem(), Settings()).status != Status::converged) {
      if (verbose) std::cout << "the default finds no answer: " << recipe << std::endl;
      continue;
    }
    std::ostringstream what;
    what << recipe;
    table.add(solve_by_all(posed.problem()), what.str(), verbose);
  }
}

/// Pressed, then driven round a loop: 25 increments, each from the exact state before.
void run_history(unsigned seed, bool verbose, Table& table) {
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
    const Solution exact = solve(posed.problem(), Settings());
    std::ostringstream what;
    what << "increment " << k << " of " << recipe;
    if (exact.status == Status::converged)
      table.add(solve_by_all(posed.problem()), what.str(), verbose);
    else if (verbose)
      std::cout << "the default finds no answer: " << what.str() << std::endl;
    u_old = posed.to_global(exact.x);
  }
}

}  // namespace

TEST(Arrival, DISABLED_OnManyBlocksAndHistories) {
  const unsigned seed = from_environment("ARRIVAL_SEED", 1);
  Table blocks, histories;
  run_blocks(from_environment("ARRIVAL_BLOCKS", 1000), seed, true, blocks);
  blocks.print("random blocks in 3D");
  for (unsigned k = 0; k < from_environment("ARRIVAL_HISTORIES", 10); ++k)
    run_history(seed + k, true, histories);
  histories.print("load increments in 3D");
  EXPECT_EQ(blocks.of(Method::gcx).missed + histories.of(Method::gcx).missed, 0u);
  EXPECT_EQ(blocks.of(Method::gcx).above_3 + histories.of(Method::gcx).above_3, 0u);
}

TEST(Arrival, GradientMethodsArriveOnBlocksInThreeDimensionsAndGcxCostsNoMoreThanThriceGc3) {
  Table table;
  run_blocks(25, 1, false, table);
  run_history(1, false, table);  // 15 and 16 of its increments stalled
  for (Method m : {Method::gc1, Method::gc2, Method::gc3, Method::gcx})
    EXPECT_EQ(table.of(m).missed, 0u) << int(m);
  EXPECT_EQ(table.of(Method::gcx).above_3, 0u);
  EXPECT_EQ(table.of(Method::sorp).ends[int(Status::stagnated)], 0u);
}
