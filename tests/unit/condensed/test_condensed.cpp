#include <gtest/gtest.h>

#include <numeric>

#include "core/condensed/elimination.h"
#include "core/condensed/condensed.h"
#include "core/solver.h"
#include "../random_scene.h"
#include "../reference.h"
#include "../verifier.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

ContactProblem posed(const BlockOptions& o) { return block(o).system().problem(); }

/// A scene drawn at random: mesh, normals, friction, gaps, loads; about half held by contact alone.
Scene random_scene(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<Real> uniform(0, 1);
  BlockOptions o;
  o.d = uniform(random) < 0.7 ? 2 : 3;
  o.cells = o.d == 2 ? 2 + int(6 * uniform(random)) : 2 + int(2 * uniform(random));
  o.clamp_side = uniform(random) < 0.5;
  o.angle = o.clamp_side ? 0 : 6 * uniform(random);
  o.distortion = 0.25 * uniform(random);
  o.seed = seed;
  o.nu = 0.45 * uniform(random);
  o.pressure = 10 * uniform(random);
  o.mu = uniform(random);
  o.shear = o.pressure * o.mu * (1.6 * uniform(random) - 0.8);
  if (o.clamp_side) o.shear *= 3;
  Scene s = block(o);
  for (Index k = 0; k < s.gap.size(); ++k) {
    s.friction[k] = o.mu * (0.5 + 0.5 * uniform(random));
    if (o.clamp_side) s.gap[k] = 2e-3 * (uniform(random) - 0.3);
    const bool on_clamp =
        s.points[k].dof[0] == 2 * o.cells;        // keeps its normal among its free dofs
    if (o.clamp_side && o.d == 2 && !on_clamp) {  // normals that differ from node to node
      const Real tilt = 0.4 * (uniform(random) - 0.5);
      s.points[k].normal = {std::sin(tilt), -std::cos(tilt), 0};
    }
  }
  return s;
}

/// A block whose rigid motions are not told, and beside it two nodes with a spring between them.
Scene beside_a_spring(const BlockOptions& o) {
  Scene s = block(o);
  const Index n = s.n;
  s.n += 4;
  for (int c = 0; c < 2; ++c)
    for (int p = 0; p < 2; ++p)
      for (int q = 0; q < 2; ++q) {
        s.i.push_back(n + 2 * p + c);
        s.j.push_back(n + 2 * q + c);
        s.a.push_back(p == q ? 100 : -100);
      }
  s.b.conservativeResize(s.n);
  s.b.tail(4).setZero();
  s.modes = {};
  return s;
}

}  // namespace

TEST(Condensed, AgreesWithTheReferenceOn200RandomScenes) {
  const unsigned first_seed = 1000;
  int compared = 0, other_solution = 0, unsolvable = 0;
  for (unsigned k = 0; k < 200; ++k) {
    const Scene s = random_scene(first_seed + k);
    const Posed system = s.system();
    const ContactProblem& p = system.problem();
    const Solution a = solve(p, Settings());
    const Reference b = reference_solution(p);
    if (a.status != Status::converged) {
      // then the reference must not have an answer that the laws accept, either
      EXPECT_FALSE(b.converged && certify(p, b.x).residual < 1e-8)
          << "seed " << first_seed + k << " status " << int(a.status);
      ++unsolvable;
      continue;
    }
    const Verdict v = verify(s, system.to_global(a.x), system.force_to_global(a.certificate.r));
    EXPECT_LT(v.worst(), 1e-8) << "seed " << first_seed + k;
    if (!b.converged) continue;
    if ((a.x - b.x).norm() <= 1e-9 * b.x.norm()) {
      ++compared;
    } else {
      // Coulomb's law may have several solutions: both must be true ones
      ++other_solution;
      EXPECT_LT(certify(p, b.x).residual, 1e-9) << "seed " << first_seed + k;
    }
  }
  EXPECT_GE(compared, 150);
  EXPECT_LE(other_solution, 5);
  EXPECT_LE(unsolvable, 20);
  RecordProperty("compared", compared);
  std::printf("200 random scenes: %d agree, %d another true solution, %d not solved by either\n",
              compared, other_solution, unsolvable);
}

TEST(Condensed, AgreesWithTheConjugateGradientOnAToTheRegularizationsBound) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = d == 2 ? 10 : 4;
    o.clamp_side = true;
    o.shear = 4;
    const ContactProblem p = posed(o);
    const Solution a = solve(p, Settings());
    for (Real eps : {1e-4, 1e-6, 1e-8}) {
      Settings settings{Method::gc3};
      settings.tol = 1e-10;
      settings.regeps = eps * a.x.lpNorm<Eigen::Infinity>();
      const Vector e = solve(p, settings).x - a.x;
      const Real error =
          std::sqrt(e.dot(p.system->entries() * e) / a.x.dot(p.system->entries() * a.x));
      EXPECT_LT(error, 3 * eps) << d;
    }
  }
}

TEST(Condensed, FurtherPassesRefineTheFirstAndTheBestIsKept) {
  int solved = 0, refined = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Recipe recipe = random_recipe(seed);
    recipe.block.nu = 0.4999;
    const Posed posed = make_scene(recipe).system();
    const auto by_itself = [&](Real tol) {
      CondensedSolver solver(posed.problem().system);
      EXPECT_EQ(solver.factor(1e9), Elimination::Outcome::done);
      Settings settings;
      settings.tol = tol;
      return solver.solve({posed.problem(), settings, {}, nullptr});
    };
    const Solution first = by_itself(1e-5);
    if (first.status != Status::converged || first.layer != Layer::newton) continue;
    const Real best = by_itself(1e-18).certificate.residual;
    // Newton keeps the best by the laws on the contact dofs; the certificate's own rounding is
    // 1e-12 here.
    EXPECT_LE(best, std::max(first.certificate.residual, 1e-12)) << recipe;
    ++solved;
    refined += best < first.certificate.residual;
  }
  EXPECT_GE(solved, 30);
  EXPECT_GE(refined, 0.5 * solved);
}

TEST(Condensed, APathOnAThatDoesNotArriveLeavesTheNextLayerItsLoad) {
  int answers = 0;
  for (unsigned seed : {240, 326, 385, 566}) {
    const Posed posed = make_scene(random_recipe(seed)).system();
    const ContactProblem p = posed.problem();
    CondensedSolver solver(p.system);
    ASSERT_EQ(solver.factor(1e9), Elimination::Outcome::done);
    const auto astray = [&](Index) -> std::optional<Solution> {
      Solution s;
      s.x = Vector::Ones(p.dofs());
      s.status = Status::stagnated;
      return s;
    };
    const Solution a = solver.solve({p, Settings(), {}, nullptr}, astray);
    EXPECT_EQ(a.status, Status::converged) << seed;
    EXPECT_LT(a.certificate.residual, 1e-8) << seed;
    answers += a.layer == Layer::proximal;
  }
  EXPECT_GE(answers, 3);
}

TEST(Condensed, AFurtherIncrementStartsFromStickWhereTheLastAnswerWasClosed) {
  for (Law law : {Law::frictionless, Law::coulomb}) {
    BlockOptions o;
    o.cells = 8;
    o.clamp_side = true;
    o.shear = 40;  // nodes open
    o.law = law;
    const ContactProblem p = posed(o);
    CondensedSolver solver(p.system);
    ASSERT_EQ(solver.factor(1e9), Elimination::Outcome::done);
    const Request request{p, Settings(), {}, nullptr};
    const Solution first = solver.solve(request), next = solver.solve(request);
    EXPECT_LT(next.iterations, first.iterations);
    if (law == Law::frictionless) {
      EXPECT_LE(next.iterations, 2);  // a step, and one that ends it
    }
    EXPECT_LT((next.x - first.x).norm(), 1e-9 * first.x.norm());
  }
}

TEST(Condensed, ALoadOnABodyThatFloatsBesideTheOthersTakesNoStep) {
  Scene s = beside_a_spring(BlockOptions());
  s.b.tail(4) << 1, 0, 1, 0;
  const Posed posed = s.system();
  const Solution a = solve(posed.problem(), Settings());
  EXPECT_EQ(a.status, Status::no_equilibrium);
  EXPECT_EQ(a.iterations, 0);
  EXPECT_GT(a.unheld_motion.cwiseAbs().maxCoeff(), 0);
}

TEST(Condensed, WhatFloatsAndWhatSlidesFreelyIsUndeterminedTogether) {
  BlockOptions o;
  o.clamp_side = false;
  o.law = Law::frictionless;
  o.shear = 0;
  const Posed posed = beside_a_spring(o).system();
  const Solution a = solve(posed.problem(), Settings());
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.undetermined.cols(), 3);  // the spring along both axes, the block along the floor
}

TEST(Condensed, WhatFloatsAndWhatHoversIsUndeterminedTogether) {
  BlockOptions o;
  o.clamp_side = false;
  o.pressure = o.shear = 0;
  Scene s = beside_a_spring(o);
  s.gap.setConstant(1e-3);
  for (int p = 0; p < 2; ++p)  // the load is on springs that hold it
    for (int q = 0; q < 2; ++q) {
      s.i.push_back(s.n + p);
      s.j.push_back(s.n + q);
      s.a.push_back(p == q ? 200 : -100);
    }
  s.n += 2;
  s.b.conservativeResize(s.n);
  s.b.tail(2).setOnes();
  const Posed posed = s.system();
  const Solution a = solve(posed.problem(), Settings());
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.undetermined.cols(), 5);  // both ends of the other spring, and the block
}

TEST(Condensed, PermutedNumberingGivesTheSameAnswer) {
  BlockOptions o;
  o.cells = 6;
  Scene s = block(o);
  const Vector u = [&] {
    const Posed system = s.system();
    return system.to_global(solve(system.problem(), Settings()).x);
  }();
  std::vector<Index> place(s.n);
  std::iota(place.begin(), place.end(), 0);
  std::shuffle(place.begin(), place.end(), std::mt19937(3));
  Scene t = s;
  for (std::size_t k = 0; k < s.a.size(); ++k) {
    t.i[k] = place[s.i[k]];
    t.j[k] = place[s.j[k]];
  }
  for (Index i = 0; i < s.n; ++i) t.b[place[i]] = s.b[i];
  for (ContactPoint& p : t.points)
    for (int c = 0; c < 2; ++c) p.dof[c] = place[p.dof[c]];
  std::shuffle(t.points.begin(), t.points.end(), std::mt19937(4));
  const Posed system = t.system();
  const Vector v = system.to_global(solve(system.problem(), Settings()).x);
  for (Index i = 0; i < s.n; ++i)
    EXPECT_NEAR(v[place[i]], u[i], 1e-11 * u.lpNorm<Eigen::Infinity>());
}

TEST(Condensed, AKeptFactorGivesWhatAFreshOneGives) {
  BlockOptions o;
  o.clamp_side = true;
  Scene s = block(o);
  Posed kept = s.system();
  Solver solver(kept.problem().system);
  Settings settings;
  EXPECT_GT(solver.solve(kept.problem().increment, settings).times.factor, 0);
  s.b *= 1.5;
  s.friction *= 2;
  s.gap.setConstant(1e-3);
  kept.pose(s.b, {}, s.laws());
  const Solution again = solver.solve(kept.problem().increment, settings);
  EXPECT_EQ(again.times.factor, 0);
  const Posed fresh = s.system();
  EXPECT_LT((again.x - solve(fresh.problem(), settings).x).norm(), 1e-12 * again.x.norm());
}

TEST(Condensed, LargeFrictionIsSolvedOrNamed) {
  for (int d : {2, 3})
    for (Real mu : {1.0, 2.0, 3.0, 5.0, 10.0}) {
      BlockOptions o;
      o.d = d;
      o.cells = d == 2 ? 24 : 5;
      o.clamp_side = true;
      o.mu = mu;
      o.pressure = 50;
      o.shear = 100;
      const Scene s = block(o);
      const Posed system = s.system();
      const Solution a = solve(system.problem(), Settings());
      if (a.status == Status::converged) {
        EXPECT_LT(a.certificate.residual, 1e-8);
        EXPECT_LT(verify(s, system.to_global(a.x), system.force_to_global(a.certificate.r)).worst(),
                  1e-8);
      } else {
        EXPECT_GT(mu, 5) << d;
      }
    }
}

TEST(Condensed, FrictionlessContactCondensesTheNormalsOnly) {
  BlockOptions o;
  o.law = Law::frictionless;
  o.clamp_side = true;
  const ContactProblem p = posed(o);
  EXPECT_EQ(p.contact_dofs(), p.nodes());
  EXPECT_LT(solve(p, Settings()).certificate.residual, 1e-12);
}

TEST(Condensed, OrderingMeshNodesInPlaceOfDofsChangesNoAnswer) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    const Scene s = block(o);
    const Posed by_dofs = s.system(), by_nodes = s.system(mesh_nodes(s));
    const Vector u = by_dofs.to_global(solve(by_dofs.problem(), Settings()).x);
    const Vector v = by_nodes.to_global(solve(by_nodes.problem(), Settings()).x);
    EXPECT_LT((u - v).norm(), 1e-11 * u.norm());
  }
}

TEST(Condensed, TangentsWithoutAFrictionLawSlideFreely) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = d == 2 ? 5 : 2;
    o.clamp_side = true;
    Scene s = block(o), bare = s;
    s.law = bare.law = Law::frictionless;
    for (ContactPoint& p : bare.points) p.friction = false;
    const Posed with = s.system(), without = bare.system();
    const Solution a = solve(with.problem(), Settings()), b = solve(without.problem(), Settings());
    ASSERT_EQ(a.status, Status::converged);
    EXPECT_EQ(a.layer, Layer::newton);
    const Vector u = with.to_global(a.x), v = without.to_global(b.x);
    EXPECT_LT((u - v).norm(), 1e-10 * v.norm());
  }
}
