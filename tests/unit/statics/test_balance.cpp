// The conic test against linear programs, on random bodies of a few nodes in the plane: verdicts by
// the thousand. BALANCE_SCENES and BALANCE_SEED in the environment choose how many, and which.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <random>

#include "../statics.h"
#include "core/statics/equilibrium.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

struct RandomBody {
  ContactProblem problem;
  DenseMatrix W;  // 2 m x 3

  explicit RandomBody(unsigned seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](Real a, Real b) {
      return std::uniform_real_distribution<Real>(a, b)(random);
    };
    const Index m = 1 + Index(uniform(0, 8));
    W.resize(2 * m, 3);
    Increment& now = problem.increment;
    now.mu.resize(m);
    now.g.resize(m);
    // few directions: floors, walls, ceilings and corners are the rule, not the exception
    const Real base = uniform(0, 6.3);
    for (Index i = 0; i < m; ++i) {
      const Real turn = uniform(0, 1) < 0.8 ? M_PI / 2 * int(uniform(0, 4)) : uniform(0, 6.3);
      const Real nx = std::cos(base + turn), ny = std::sin(base + turn);
      const Real x = uniform(-1, 1), y = uniform(0, 1) < 0.5 ? 0 : uniform(-1, 1);
      W.row(2 * i) << nx, ny, x * ny - y * nx;
      W.row(2 * i + 1) << -ny, nx, x * nx + y * ny;
      now.mu[i] = uniform(0, 1) < 0.3 ? 0 : uniform(0, 1.2);
      now.g[i] = uniform(0, 1) < 0.3 ? 0 : uniform(0, 1);
    }
    now.law = uniform(0, 1) < 0.5 ? Law::coulomb : Law::tresca;
    now.bilateral = uniform(0, 1) < 0.3;
    now.gap = Vector::Zero(m);
    now.F.resize(2 * m);
    for (Index k = 0; k < 2 * m; ++k) now.F[k] = uniform(-1, 1);
    const auto system = std::make_shared<AssembledSystem>();
    for (Index first = 0; first <= 2 * m; first += 2) system->first.push_back(first);
    system->A.resize(2 * m, 2 * m);  // 0: all motions are rigid
    system->weight = Vector::Ones(2 * m);
    problem.system = system;
    if (now.law == Law::tresca) return;
    if (uniform(0, 1) < 0.5) now.cohesion = now.g;
    if (uniform(0, 1) >= 0.5) return;
    now.cap.resize(m);
    for (Index i = 0; i < m; ++i) now.cap[i] = uniform(0, 1) < 0.3 ? 1e9 : uniform(0, 1.5);
  }

  /// By the linear program, with friction times a factor.
  bool held(Real factor) const {
    const Increment& now = problem.increment;
    const bool coulomb = now.law == Law::coulomb;
    const Vector none, &given = coulomb ? now.cohesion : now.g, &caps = coulomb ? now.cap : none;
    const int m = problem.nodes(), bounded = given.size() + caps.size() > 0 ? m : 0;
    std::vector<Vector> columns;
    const auto add = [&](const Vector& force, int node) {
      columns.push_back(Vector::Zero(3 + bounded));
      columns.back().head(3) = force;
      if (node >= 0) columns.back()[3 + node] = 1;
    };
    Vector load = Vector::Zero(3 + bounded);
    load.head(3) = W.transpose() * now.F;
    for (int i = 0; i < m; ++i) {
      const Vector N = W.row(2 * i), T = W.row(2 * i + 1);
      const bool capped = caps.size() > 0 && caps[i] < 1e8;
      const Real mu = coulomb && !capped ? factor * now.mu[i] : 0;
      const Real c = given.size() > 0 ? given[i] : 0, cap = capped ? caps[i] : INFINITY;
      const Real most = coulomb && c < cap && now.mu[i] > 0 ? (cap - c) / now.mu[i] : 0;
      for (Real side : {-1.0, 1.0})
        for (Real way : {-1.0, 1.0}) {
          if (way < 0 && !now.bilateral) continue;
          add(way * N + side * mu * T, -1);
          // shares of the limit, that sum to at most 1
          if (bounded > 0) add(side * factor * std::min(c, cap) * T, i);
          if (capped && most > 0) add(way * most * N + side * factor * cap * T, i);
        }
      if (bounded == 0) continue;
      add(Vector::Zero(3), i);
      load[3 + i] = 1;
    }
    DenseMatrix G(3 + bounded, columns.size());
    for (std::size_t k = 0; k < columns.size(); ++k) G.col(k) = columns[k];
    return distance_to_cone(G, load) < 1e-9;
  }
};

}  // namespace

TEST(Balance, AgreesWithALinearProgramOnRandomBodies) {
  const auto from = [](const char* name, unsigned otherwise) {
    const char* value = std::getenv(name);
    return value ? unsigned(std::strtoul(value, nullptr, 10)) : otherwise;
  };
  const unsigned count = from("BALANCE_SCENES", 3000), first = from("BALANCE_SEED", 1);
  unsigned unheld = 0, unsure = 0;
  for (unsigned seed = first; seed < first + count; ++seed) {
    const RandomBody body(seed);
    const bool truth = body.held(1), shown = unheld_motion(body.W, body.problem).has_value();
    EXPECT_FALSE(shown && truth) << seed;
    unheld += shown;
    if (shown || truth || body.held(1 + 1e-3)) continue;
    ++unsure;
    if (std::getenv("BALANCE_VERBOSE")) std::cout << "open " << seed << "\n";
  }
  std::cout << "balance: " << unheld << " of " << count << " not held, of " << unsure
            << " more nothing is shown\n";
  EXPECT_GT(unheld, count / 10);
  EXPECT_LE(unsure, count / 1000);
}
