// Method multigrid against the independent verifier, and against the condensed route.
#include <gtest/gtest.h>

#include "../gradient/block3d.h"
#include "../gradient/recorder.h"
#include "../verifier.h"
#include "core/multigrid/multigrid_solver.h"
#include "core/solver.h"
#include "scene_in_blocks.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

struct Answer {
  Solution solution;
  Verdict verdict;
  Real off = 0;  ///< from the condensed route
};

Solution by(Method method, const ContactProblem& problem) {
  Settings settings{method};
  settings.tol = 1e-9;
  return Solver(problem.system).solve(problem.increment, settings);
}

Answer answer(const SparseScene& scene, bool bilateral = false) {
  const SceneInBlocks s(scene);
  ContactProblem problem = s.posed.problem();
  problem.increment.bilateral = bilateral;
  Answer a;
  a.solution = by(Method::multigrid, problem);
  a.verdict = verify(scene, s.posed.to_global(a.solution.x),
                     s.posed.force_to_global(a.solution.certificate.r));
  const Solution condensed = by(Method::condensed, problem);
  a.off = (a.solution.x - condensed.x).norm() / condensed.x.norm();
  EXPECT_EQ(a.solution.status, Status::converged);
  EXPECT_EQ(a.solution.route, Route::multigrid);
  EXPECT_LE(a.solution.certificate.residual, 1e-9);
  EXPECT_LT(a.off, 1e-7);
  return a;
}

}  // namespace

TEST(Multigrid, ObeysTheLawsAndAgreesWithTheCondensedRouteOnBlocks) {
  for (bool clamp : {true, false})
    for (Real mu : {0.05, 0.3, 1.0}) {
      SparseOptions o = cube_of(8);
      o.clamp_side = clamp;
      o.mu = mu;
      o.shear = clamp ? 2 : 0.6 * std::min(mu, 0.5) * o.pressure;
      o.distortion = 0.2;
      const Answer a = answer(sparse_block(o));
      EXPECT_LT(a.verdict.worst(), 1e-5) << clamp << " " << mu;
      EXPECT_LE(a.solution.iterations, 40) << clamp << " " << mu;
    }
}

TEST(Multigrid, SolvesWithoutFriction) {
  SparseOptions o = cube_of(8);
  o.mu = 0;
  o.curvature = 0.02;
  EXPECT_LT(answer(sparse_block(o)).verdict.worst(), 1e-5);
  o.law = Law::frictionless;
  EXPECT_LT(answer(sparse_block(o)).verdict.worst(), 1e-5);
}

TEST(Multigrid, SolvesAPlateAndASphereLikeGap) {
  for (Real mu : {0.3, 1.0}) {
    SparseOptions plate = cube_of(20);
    plate.cells[2] = 3;
    plate.size[2] = 0.15;
    plate.clamp_side = false;
    plate.shear = 1;
    plate.mu = mu;
    EXPECT_LT(answer(sparse_block(plate)).verdict.worst(), 1e-5) << mu;
    SparseOptions sphere = cube_of(10);
    sphere.push_top = true;
    sphere.clamp_side = false;
    sphere.curvature = 0.5;
    sphere.mu = mu;
    EXPECT_LT(answer(sparse_block(sphere)).verdict.worst(), 1e-5) << mu;
  }
}

TEST(Multigrid, SolvesInTwoDimensionsInTurnedFramesAndWithContrast) {
  SparseOptions flat = cube_of(30), turned = cube_of(8), contrast = cube_of(8);
  flat.d = 2;
  turned.tilt = 0.4;
  turned.push_top = true;
  contrast.contrast = 1e4;
  contrast.aspect = 5;
  for (const SparseOptions& o : {flat, turned, contrast})
    EXPECT_LT(answer(sparse_block(o)).verdict.worst(), 1e-5) << o.d << o.tilt << o.contrast;
}

TEST(Multigrid, SolvesCohesionAndCapsAsTheCondensedRouteDoes) {
  const SceneInBlocks scene(sparse_block(cube_of(6)));
  ContactProblem p = scene.posed.problem();
  const Vector before = by(Method::condensed, p).x;
  Vector last = before;
  for (Vector* values : {&p.increment.cohesion, &p.increment.cap}) {
    *values = Vector::Constant(p.nodes(), values == &p.increment.cap ? 0.02 : 0.01);
    const Solution exact = by(Method::condensed, p), s = by(Method::multigrid, p);
    EXPECT_EQ(s.status, Status::converged);
    EXPECT_EQ(s.route, Route::multigrid);
    EXPECT_LT((s.x - exact.x).norm(), 1e-5 * exact.x.norm());
    EXPECT_GT((last - exact.x).norm(), 1e-3 * exact.x.norm());
    last = exact.x;
  }
}

TEST(Multigrid, SolvesAGivenLimitBilateralContactAndOrthotropicFriction) {
  SparseOptions given = cube_of(8), orthotropic = cube_of(8);
  given.law = Law::tresca;
  given.mu = 0.03;
  EXPECT_LT(answer(sparse_block(given)).verdict.worst(), 1e-5);
  orthotropic.mu_ratio = 2.5;
  EXPECT_LT(answer(sparse_block(orthotropic)).verdict.worst(), 1e-5);
  const Answer bilateral = answer(sparse_block(cube_of(8)), true);
  EXPECT_LE(bilateral.verdict.cone, 1e-5);
}

TEST(Multigrid, BilateralContactThatIsPulledSlidesAsWhereItIsPushed) {
  SparseOptions o = cube_of(6);
  o.mu = 0.1;
  const auto solved = [&o](Real sign) {
    o.pressure = sign * 10;
    o.shear = sign * 3;
    const SceneInBlocks s(o);
    ContactProblem problem = s.posed.problem();
    problem.increment.bilateral = true;
    return by(Method::multigrid, problem);
  };
  const Solution pushed = solved(1), pulled = solved(-1);
  EXPECT_EQ(pulled.status, Status::converged);
  EXPECT_EQ(pulled.route, Route::multigrid);
  EXPECT_EQ(pulled.iterations, pushed.iterations);
  EXPECT_EQ(pulled.state, pushed.state);
  EXPECT_GT(std::count(pushed.state.begin(), pushed.state.end(), NodeState::slip), 20);
  EXPECT_LT((pulled.x + pushed.x).norm(), 1e-7 * pushed.x.norm());
}

TEST(Multigrid, ItsIterationsDoNotGrowWithTheMesh) {
  Index iterations[2];
  int k = 0;
  for (int n : {8, 16}) {
    const SceneInBlocks s(cube_of(n));
    iterations[k++] = by(Method::multigrid, s.posed.problem()).iterations;
  }
  EXPECT_LE(iterations[1], iterations[0] + 6);
}

TEST(Multigrid, HoldsABodyThatLittleMoreThanFrictionHolds) {
  SparseOptions o = cube_of(6);
  o.clamp_side = false;
  o.mu = 0.3;
  o.shear = 0.99 * 0.3 * o.pressure;
  EXPECT_LT(answer(sparse_block(o)).verdict.worst(), 1e-5);
  // on a curved obstacle only springs keep it from rolling away on the faces in between
  o.shear = 0.1;
  o.curvature = 0.7;
  o.cells = {4, 4, 4};
  answer(sparse_block(o));
}

TEST(Multigrid, NamesALoadThatNothingHoldsWithoutIterating) {
  for (Law law : {Law::coulomb, Law::tresca}) {
    SparseOptions o = cube_of(4);
    o.clamp_side = false;
    o.law = law;
    o.mu = law == Law::coulomb ? 0.3 : 1e-3;
    o.shear = 1.1 * 0.3 * o.pressure;
    const SceneInBlocks s(o);
    const Solution a = by(Method::multigrid, s.posed.problem());
    EXPECT_EQ(a.status, Status::no_equilibrium);
    EXPECT_EQ(a.iterations, 0);
    EXPECT_EQ(a.unheld_motion.size(), s.system->dofs());
  }
}

TEST(Multigrid, AFurtherIncrementKeepsTheHierarchyAndStartsFromTheLastFaces) {
  const SceneInBlocks s(cube_of(12));
  Solver solver(s.system);
  Settings settings{Method::multigrid};
  Increment increment = s.posed.problem().increment;
  const Solution first = solver.solve(increment, settings);
  EXPECT_GT(first.times.factor, 0);
  increment.F *= 1.05;
  const Solution second = solver.solve(increment, settings);
  EXPECT_EQ(second.status, Status::converged);
  EXPECT_EQ(second.times.factor, 0);
  EXPECT_LE(second.iterations, first.iterations);
  const Solution again = solver.solve(increment, settings, second.x);
  EXPECT_EQ(again.status, Status::converged);
  EXPECT_LE(again.iterations, 3);
}

TEST(Multigrid, AThirdIncrementStartsWhereTheLastTwoLedTo) {
  const SceneInBlocks s(cube_of(8));
  Solver solver(s.system), cold(s.system);
  Settings settings{Method::multigrid};
  Increment increment = s.posed.problem().increment;
  const Vector F = increment.F;
  for (Real load : {1.0, 1.1, 1.3, 1.4}) {
    increment.F = load * F;
    const Solution a = solver.solve(increment, settings);
    EXPECT_EQ(a.status, Status::converged);
    if (load > 1.1) {
      EXPECT_LE(a.iterations, 4) << load;
    }
  }
}

TEST(Multigrid, AStartThatIsFarFromTheLawsCostsNothing) {
  const SceneInBlocks s(cube_of(8));
  Settings settings{Method::multigrid};
  Increment increment = s.posed.problem().increment;
  const Vector far = 10 * Vector::Random(s.system->dofs());
  for (bool later : {false, true}) {
    Solver given(s.system), alone(s.system);
    if (later) {
      given.solve(increment, settings);
      alone.solve(increment, settings);
      increment.F *= 1.07;
    }
    EXPECT_EQ(given.solve(increment, settings, far).iterations,
              alone.solve(increment, settings).iterations);
  }
}

TEST(Multigrid, ByNameItHasTheRouteOfTheDefaultBehindIt) {
  Settings named{Method::multigrid};
  const SceneInBlocks s(cube_of(10));
  const Costs costs = make_plan(s.posed.problem(), named).costs;
  EXPECT_EQ(costs.condensed, make_plan(s.posed.problem(), Settings()).costs.condensed);
  EXPECT_GT(costs.condensed, 0);
}

TEST(Multigrid, ANodeThatTheNextIncrementLeavesWithoutAnObstacleOpens) {
  const SceneInBlocks s(cube_of(6));
  Solver solver(s.system);
  Settings settings{Method::multigrid};
  Increment increment = s.posed.problem().increment;
  const Solution first = solver.solve(increment, settings);
  Index closed = 0;
  while (first.state[closed] == NodeState::separated) ++closed;
  increment.gap[closed] = std::numeric_limits<Real>::infinity();
  const Solution second = solver.solve(increment, settings);
  EXPECT_EQ(second.status, Status::converged);
  EXPECT_EQ(second.layer, Layer::multigrid);
  EXPECT_EQ(second.state[closed], NodeState::separated);
  EXPECT_LE(second.iterations, first.iterations);
}

TEST(Multigrid, WithoutCoordinatesTheCondensedRouteAnswers) {
  SparseScene scene = sparse_block(cube_of(3));
  Settings settings{Method::multigrid};
  const Posed without_nodes = scene.system();
  scene.modes.resize(0, 0);
  const Posed without_modes = scene.system(scene.node_of_dof);
  for (const Posed* posed : {&without_nodes, &without_modes}) {
    const Solution a = solve(posed->problem(), settings);
    EXPECT_EQ(a.status, Status::converged);
    EXPECT_EQ(a.layer, Layer::newton);
    EXPECT_EQ(a.levels.count, 0);
  }
}

TEST(Multigrid, ANodeWithMoreDofsThanTheDimensionHasNoHierarchy) {
  AssembledSystem system = assembled(SceneInBlocks(cube_of(3)).system);
  EXPECT_NE(make_hierarchy(system), nullptr);
  for (Index& node : system.mesh_node) node /= 2;
  EXPECT_EQ(make_hierarchy(system), nullptr);
}

TEST(Multigrid, ItsBoundOnTheIterationsHoldsForAllLayersTogether) {
  const SceneInBlocks s(cube_of(6));
  for (Index bound : {1, 3, 10}) {
    Settings settings{Method::multigrid};
    settings.nbiter = bound;
    const Solution a = Solver(s.system).solve(s.posed.problem().increment, settings);
    EXPECT_LE(a.iterations, bound);
    EXPECT_LE(a.steps.total(), bound);
    const Solution alone =
        MultigridSolver(s.system).solve(s.posed.problem(), settings, {}, nullptr);
    EXPECT_EQ(alone.status, Status::max_iterations);
    EXPECT_EQ(alone.iterations, bound);
  }
}

TEST(Multigrid, FrictionFollowsTheSlipOfNodesThatHardlySlide) {
  // the certificate is of second order there: slip times angle
  for (unsigned seed : {25u, 313u, 350u}) {
    const Scene scene = make_scene(random_block3d(seed));
    const Posed posed = scene.system(mesh_nodes(scene));
    Settings settings{Method::multigrid};
    const Solution a = solve(posed.problem(), settings);
    EXPECT_EQ(a.layer, Layer::multigrid) << seed;
    EXPECT_LT(verify(scene, posed.to_global(a.x), posed.force_to_global(a.certificate.r)).worst(),
              1e-7)
        << seed;
  }
}

TEST(Multigrid, StartsFromAGivenFieldAndFromAPreviousState) {
  SparseOptions o = cube_of(8);
  SparseScene scene = sparse_block(o);
  Settings settings{Method::multigrid};
  settings.tol = 1e-9;
  const Posed first = scene.system(scene.node_of_dof);
  const Solution a = solve(first.problem(), settings);
  scene.u_old = first.to_global(a.x);
  scene.b *= 1.1;
  const Posed second = scene.system(scene.node_of_dof);
  const Solution b = solve(second.problem(), settings);
  EXPECT_EQ(b.layer, Layer::multigrid);
  const Vector u = second.to_global(b.x);
  EXPECT_LT(verify(scene, u, second.force_to_global(b.certificate.r)).worst(), 1e-7);
  Solver solver(second.problem().system);
  const Solution c = solver.solve(second.problem().increment, settings, 1.01 * b.x);
  EXPECT_EQ(c.status, Status::converged);
  EXPECT_LT((c.x - b.x).norm(), 1e-7 * b.x.norm());
  EXPECT_LT(c.iterations, b.iterations);
}

TEST(Multigrid, TakesTheLeastOfWhatNothingDetermines) {
  SparseOptions o = cube_of(6);
  o.clamp_side = false;
  o.mu = 0;
  o.shear = 0;
  const SceneInBlocks s(o);
  const Solution a = by(Method::multigrid, s.posed.problem());
  const Solution b = by(Method::condensed, s.posed.problem());
  EXPECT_EQ(a.layer, Layer::multigrid);
  EXPECT_EQ(a.undetermined.cols(), 3);
  EXPECT_EQ(b.undetermined.cols(), 3);
  EXPECT_LT((a.x - b.x).norm(), 1e-7 * b.x.norm());
}

TEST(Multigrid, TellsTheObserverOfEachIterationAndTheLevels) {
  const SceneInBlocks s(cube_of(8));
  Settings settings{Method::multigrid};
  Recorder heard;
  const Solution a = Solver(s.system).solve(s.posed.problem().increment, settings, {}, &heard);
  EXPECT_EQ(Index(heard.steps.size()), a.iterations);
  EXPECT_EQ(a.steps.total(), a.iterations);
  EXPECT_EQ(a.levels.count, s.hierarchy->levels());
  EXPECT_EQ(a.levels.complexity, s.hierarchy->operator_complexity());
  EXPECT_EQ(a.levels.bytes, s.hierarchy->bytes());
}

TEST(Multigrid, AnIndefiniteMatrixIsNamed) {
  for (int cells : {3, 8}) {
    SparseScene scene = sparse_block(cube_of(cells));
    for (std::size_t k = 0; k < scene.a.size(); ++k)
      if (scene.i[k] != scene.j[k]) scene.a[k] *= 1.5;
    const Posed posed = scene.system(scene.node_of_dof);
    Settings settings{Method::multigrid};
    EXPECT_EQ(solve(posed.problem(), settings).status, Status::not_positive_definite);
    MultigridSolver alone(posed.problem().system);
    EXPECT_NE(alone.solve(posed.problem(), settings, {}, nullptr).status, Status::converged);
  }
}

TEST(Multigrid, TheDefaultTakesItInThreeDimensionsWhereAFactorCostsMore) {
  const SceneInBlocks large(cube_of(16)), small(cube_of(6));
  SparseOptions o = cube_of(40, 2);
  const SceneInBlocks flat(o);
  for (const auto& [scene, route] : {std::pair{&large, Route::multigrid},
                                     {&small, Route::condensed},
                                     {&flat, Route::condensed}}) {
    const Plan plan = make_plan(scene->posed.problem(), Settings());
    EXPECT_EQ(plan.route, route);
    const double worth = worth_of_factor(*scene->system, plan.costs);
    EXPECT_EQ(worth * plan.costs.multigrid < plan.costs.condensed, route == Route::multigrid);
    const Solution a = solve(scene->posed.problem(), Settings());
    EXPECT_EQ(a.status, Status::converged);
    EXPECT_EQ(a.layer, route == Route::multigrid ? Layer::multigrid : Layer::newton);
  }
  Settings regularized;
  regularized.newton = false;
  EXPECT_EQ(make_plan(large.posed.problem(), regularized).route, Route::condensed);
  const Posed unknown = sparse_block(cube_of(16)).system();
  EXPECT_EQ(make_plan(unknown.problem(), Settings()).route, Route::condensed);
}

TEST(Multigrid, TheDefaultStaysWithItFromCallToCall) {
  const SceneInBlocks s(cube_of(16));
  Solver solver(s.system);
  for (Real share : {1., 1.1}) {
    Increment increment = s.posed.problem().increment;
    increment.F *= share;
    const Solution a = solver.solve(increment, Settings());
    EXPECT_EQ(a.status, Status::converged) << share;
    EXPECT_EQ(a.layer, Layer::multigrid) << share;
  }
}

TEST(Multigrid, ACallThatWasTooShortLeavesItToTheNext) {
  const SceneInBlocks s(cube_of(16));
  Solver solver(s.system);
  Settings settings;
  settings.nbiter = 3;
  const Increment& increment = s.posed.problem().increment;
  EXPECT_EQ(solver.solve(increment, settings).status, Status::max_iterations);
  const Solution a = solver.solve(increment, Settings());
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.layer, Layer::multigrid);
}

TEST(Multigrid, TheDefaultTakesItWhereAFactorThatWasMadeNoLongerFits) {
  const SceneInBlocks s(cube_of(16));
  Solver solver(s.system);
  Settings settings{Method::condensed};
  const Increment& increment = s.posed.problem().increment;
  EXPECT_EQ(solver.solve(increment, settings).status, Status::converged);
  settings.method = Method::automatic;
  settings.memory = 1e3;
  const Solution a = solver.solve(increment, settings);
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.layer, Layer::multigrid);
}

TEST(Multigrid, TheDefaultTakesItInTwoDimensionsWhereTheDenseMatricesAreLarge) {
  AssembledSystem s;
  s.dimension = 2;
  s.rigid_modes = [] { return Eigen::MatrixXd(); };
  s.A.resize(40000, 40000);
  s.A.reserve(Eigen::VectorXi::Constant(40000, 14));
  for (Index i = 0; i < 40000; ++i)
    for (Index k = 0; k < 14; ++k) s.A.insert(i, (i + k) % 40000) = 1;
  s.mesh_node.resize(40000);
  for (Index contact : {600, 8000}) {
    s.first = {40000 - contact, 40000};
    const Costs costs = estimate_costs(s);
    EXPECT_EQ(worth_of_factor(s, costs) * costs.multigrid < costs.condensed, contact == 8000)
        << contact;
  }
}

TEST(Multigrid, TheDefaultTakesItWhereAFactorDoesNotFit) {
  const SceneInBlocks s(cube_of(6));
  Settings settings;
  settings.memory = 1000;
  const Solution a = Solver(s.system).solve(s.posed.problem().increment, settings);
  EXPECT_EQ(a.layer, Layer::multigrid);
  EXPECT_EQ(a.status, Status::converged);
}

TEST(Multigrid, TheDefaultLeavesItAfterFewCyclesWhereTheyWouldCostMoreThanAFactor) {
  SparseOptions o = cube_of(14);
  o.nu = 0.4999;
  const SceneInBlocks s(o);
  ASSERT_EQ(make_plan(s.posed.problem(), Settings()).route, Route::multigrid);
  Solver solver(s.system);
  const Increment& increment = s.posed.problem().increment;
  const Solution a = solver.solve(increment, Settings());
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.layer, Layer::newton);
  const Solution condensed = by(Method::condensed, s.posed.problem());
  EXPECT_LE(a.iterations, condensed.iterations + 10);
  // the factor is there now
  EXPECT_LE(solver.solve(increment, Settings()).iterations, condensed.iterations);
}

TEST(Multigrid, TheDefaultStaysWithItWhereGapsPressAndTheLoadIsTiny) {
  SparseOptions o = cube_of(14);
  o.pressure = 1e-7;
  o.shear = 0;
  SparseScene scene = sparse_block(o);
  scene.gap.setConstant(-0.01);
  const SceneInBlocks s(scene);
  const Solution a = solve(s.posed.problem(), Settings());
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.layer, Layer::multigrid);
}

TEST(Multigrid, TheDefaultSaysThatItsBoundIsUsedUpWhereMultigridGaveWayBefore) {
  SparseOptions o = cube_of(14);
  o.nu = 0.4999;
  const SceneInBlocks s(o);
  for (Index bound : {8, 10, 12}) {
    Settings settings;
    settings.nbiter = bound;
    const Solution a = solve(s.posed.problem(), settings);
    EXPECT_EQ(a.status, Status::max_iterations) << bound;
    EXPECT_LE(a.iterations, bound);
  }
}

TEST(Multigrid, TheDefaultTakesAtMostOneFifthMoreThanTheCheaperRoute) {
  // in units of the condensed route, by the cycles that cost as much
  // where both cost about the same, at 0.498 and 0.499, it may see too late that faces do not
  // settle, and by how much depends on rounding
  for (Real nu : {0.45, 0.48, 0.49, 0.495, 0.497, 0.4999}) {
    SparseOptions o = cube_of(14);
    o.nu = nu;
    const SceneInBlocks s(o);
    const ContactProblem& problem = s.posed.problem();
    const Costs costs = make_plan(problem, Settings()).costs;
    const Real affordable = 40 * costs.condensed / costs.multigrid;
    Settings named{Method::multigrid};
    const Real multigrid = solve(problem, named).iterations / affordable;
    const Solution a = solve(problem, Settings());
    const bool fell_back = a.layer != Layer::multigrid;
    const Index newton = fell_back ? solve(problem, Settings{Method::condensed}).iterations : 0;
    const Real taken = (a.iterations - newton) / affordable + fell_back;
    EXPECT_LE(taken, 1.2 * std::min(1.0, multigrid)) << nu << " " << multigrid;
  }
}

TEST(Multigrid, TheDefaultStaysWithItWhereItIsTheCheaper) {
  for (Real nu : {0.3, 0.45})
    for (bool plate : {false, true}) {
      SparseOptions o = cube_of(plate ? 32 : 16);
      o.nu = nu;
      o.clamp_side = !plate;
      if (plate) o.cells[2] = 4, o.size[2] = 0.125, o.shear = 1;
      const SceneInBlocks s(o);
      const Solution a = solve(s.posed.problem(), Settings());
      EXPECT_EQ(a.layer, Layer::multigrid) << nu << plate;
    }
}
