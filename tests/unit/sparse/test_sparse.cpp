// Sparse factors of A: alone, under the central path, and as the route of slender bodies.
#include <gtest/gtest.h>

#include "../statics/bodies.h"
#include "../multigrid/scene_in_blocks.h"
#include "../verifier.h"
#include "core/condensed/interior_point.h"
#include "core/solver.h"
#include "core/sparse/factored_matrix.h"
#include "core/statics/rigid_motions.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// A plate 100 times as wide as thick, held at its side, that a pressure bends onto a floor.
SparseOptions plate(int cells) {
  SparseOptions o;
  o.cells = {cells, cells, 1};
  o.size = {1, 1, 0.01};
  o.pressure = 1e-4;
  o.shear = 0;
  o.mu = 0.2;
  return o;
}

}  // namespace

TEST(FactoredMatrix, SolvesForTheFreeDofsWithWhatSpringsAndLawsAdd) {
  for (int d : {2, 3}) {
    const Posed posed = block(sheared_at_side(d)).system();
    const SystemPtr system = posed.problem().system;
    const Index interior = system->interior(), n = system->dofs(), m = system->contact_dofs();
    Vector springs = Vector::LinSpaced(m, 1, 2);
    std::vector<char> fixed(m, 0);
    fixed[0] = fixed[m - 1] = 1;
    Eigen::MatrixXd M = Eigen::MatrixXd(system->entries());
    M.diagonal().tail(m) += springs;
    std::vector<TangentialStiffness> W;
    if (d == 3) {
      W.push_back({system->first[1] + 1, (Eigen::Matrix2d() << 5, 3, 3, 7).finished()});
      M.block<2, 2>(W[0].first, W[0].first) += W[0].M;
    }
    FactoredMatrix factor(system);
    ASSERT_TRUE(factor.laid_out());
    EXPECT_GT(factor.flops(), 0);
    EXPECT_GT(factor.bytes(), 8. * n);
    for (int again : {0, 1}) {
      factor.truncate(fixed, W, springs);
      ASSERT_TRUE(factor.definite());
      Vector z, r = Vector::Random(n);
      factor.apply(r, z);
      EXPECT_EQ(z[interior], 0);
      EXPECT_EQ(z[n - 1], 0);
      Vector left = r - M * z;
      left[interior] = left[n - 1] = 0;
      EXPECT_LT(left.norm(), 1e-11 * r.norm()) << d << again;
    }
  }
}

TEST(FactoredMatrix, SaysWhereAMatrixIsNotDefiniteAndRecovers) {
  const Posed posed = block(sheared_at_side(2)).system();
  const SystemPtr system = posed.problem().system;
  const Index m = system->contact_dofs();
  FactoredMatrix factor(system);
  const std::vector<char> none(m, 0);
  const Vector r = Vector::Random(system->dofs());
  Vector z;
  factor.truncate(none, {}, Vector::Constant(m, -1e6));
  EXPECT_FALSE(factor.definite());
  factor.apply(r, z);
  EXPECT_TRUE(z.isZero(0));
  factor.truncate(none, {}, Vector::Ones(m));
  EXPECT_TRUE(factor.definite());
  factor.apply(r, z);
  Vector left = r - system->entries() * z;
  left.tail(m) -= z.tail(m);
  EXPECT_LT(left.norm(), 1e-11 * r.norm());
}

TEST(FactoredMatrix, KnowsWhatItWasTruncatedTo) {
  const Posed posed = block(sheared_at_side(2)).system();
  const SystemPtr system = posed.problem().system;
  const std::vector<char> none(system->contact_dofs(), 0), all(system->contact_dofs(), 1);
  FactoredMatrix factor(system);
  factor.truncate(none, {}, Vector::Zero(system->contact_dofs()));
  EXPECT_TRUE(factor.is_of(none));
  EXPECT_FALSE(factor.is_of(all));
  factor.truncate(none, {}, Vector::Ones(system->contact_dofs()));
  EXPECT_FALSE(factor.is_of(none)) << "springs";
  factor.truncate(none, {}, {});
  EXPECT_TRUE(factor.is_of(none));
  factor.renew(system);
  EXPECT_FALSE(factor.is_of(none)) << "another matrix";
}

TEST(FactoredMatrix, TakesMoreMemoryThanItsEntriesDo) {
  SparseOptions beam;
  beam.d = 2;
  beam.cells = {225, 2, 1};
  beam.size = {50, 1, 1};
  for (const SparseOptions& o : {beam, plate(18)}) {  // without supernodes, and with them
    const SceneInBlocks s(o);
    const FactoredMatrix factor(s.system);
    const Real entries = factor.operator_complexity() * s.system->entries().nonZeros() / 2;
    EXPECT_GT(factor.bytes(), 9 * entries) << o.d;
    EXPECT_LT(factor.bytes(), 13 * entries) << o.d;
  }
}

TEST(SparsePath, EndsWhereThePathOnTheContactDofsEnds) {
  for (int d : {2, 3})
    for (Law law : {Law::frictionless, Law::tresca, Law::coulomb}) {
      OnContact condensed(block(sheared_at_side(d, law)));
      const ContactProblem& problem = condensed.posed.problem();
      const CondensedProblem on_S = condensed.problem();
      CentralPath dense(on_S);
      FactoredMatrix factor(problem.system);
      CentralPath sparse(problem, std::make_unique<SparsePathMatrix>(*problem.system, factor),
                         problem.increment.F, problem.system->weight, nullptr);
      ASSERT_GT(dense.follow(100), 3);
      const Index steps = sparse.follow(100);
      EXPECT_GT(steps, 3) << d << int(law);
      EXPECT_LE(steps, 25) << d << int(law);
      const Vector x = sparse.x().tail(problem.contact_dofs());
      EXPECT_LT((x - dense.x()).norm(), 1e-5 * x.norm()) << d << int(law);
      EXPECT_LT(condensed.residual(x), 1e-4) << d << int(law);
    }
}

TEST(Slenderness, IsTheRatioOfLengthToThickness) {
  for (int d : {2, 3}) {
    SparseOptions o;
    o.d = d;
    o.cells = {20, 4, 4};
    o.size = {50, 1, 1};
    if (d == 3) std::swap(o.size[0], o.size[1]), std::swap(o.cells[0], o.cells[1]);
    o.clamp_side = false;
    const SceneInBlocks s(o);
    const Real ratio = s.system->slenderness();
    EXPECT_GT(ratio, 40) << d;
    EXPECT_LT(ratio, 60) << d;
  }
  EXPECT_LT(SceneInBlocks(SparseOptions()).system->slenderness(), 1.5);
}

TEST(SparseRoute, IsWeighedForSlenderBodiesWhereTheDenseOneTakesLonger) {
  const auto weighed = [](int cells, Real thickness) {
    SparseOptions o = plate(cells);
    o.size[2] = thickness;
    return estimate_costs(*SceneInBlocks(o).system);
  };
  const Costs thin = weighed(24, 1. / 45), thick = weighed(24, 1. / 25), few = weighed(6, 1. / 45);
  EXPECT_LT(thin.sparse, 3 * thin.condensed);
  EXPECT_EQ(thin.condensed, thick.condensed);
  EXPECT_TRUE(std::isinf(thick.sparse));
  EXPECT_TRUE(std::isinf(few.sparse));
}

TEST(SparseRoute, IsWeighedForBeamsOfTheWholePlaneToo) {
  SparseOptions o;
  o.d = 2;
  o.cells = {225, 2, 1};
  o.size = {50, 1, 1};
  const SceneInBlocks slender(o);
  o.size[0] = 10;
  const SceneInBlocks stocky(o);
  const Plan a = make_plan(slender.posed.problem(), Settings()),
             b = make_plan(stocky.posed.problem(), Settings());
  EXPECT_TRUE(std::isfinite(a.costs.sparse));
  EXPECT_EQ(a.route, Route::multigrid);
  EXPECT_EQ(a.costs.multigrid, b.costs.multigrid);
  o.cells = {240, 10, 1};
  o.size = {24, 1, 1};
  EXPECT_TRUE(std::isfinite(estimate_costs(*SceneInBlocks(o).system).sparse));
  EXPECT_EQ(b.route, Route::condensed);
}

TEST(SparseRoute, AnswersForPlatesThatFallFarAfterFewCyclesAndAsTheCondensedRouteDoes) {
  SparseScene scene = sparse_block(plate(18));
  scene.gap.setConstant(1e-2);
  const Posed posed = scene.system(scene.node_of_dof);
  ASSERT_EQ(make_plan(posed.problem(), Settings()).route, Route::multigrid);
  Solver solver(posed.problem().system);
  const Solution a = solver.solve(posed.problem().increment, Settings());
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.route, Route::sparse);
  EXPECT_EQ(a.layer, Layer::sparse_interior_point);
  EXPECT_LE(a.steps[StepLabel::conjugate], 10);  // all but two of multigrid's cycles
  EXPECT_LE(a.iterations, 30);
  const auto verdict = verify(scene, posed.to_global(a.x), posed.force_to_global(a.certificate.r));
  EXPECT_LT(verdict.worst(), 1e-5);
  Settings settings{Method::condensed};
  const Solution b = solve(posed.problem(), settings);
  EXPECT_EQ(b.status, Status::converged);
  EXPECT_LT((a.x - b.x).norm(), 1e-5 * b.x.norm());
  // the next increment starts from the faces of the last
  const Solution again = solver.solve(posed.problem().increment, Settings());
  EXPECT_EQ(again.status, Status::converged);
  EXPECT_EQ(again.layer, Layer::sparse_newton);
  EXPECT_LE(again.iterations, 10);
  // another matrix, of another pattern: the layout is its own
  SparseScene less = scene;
  std::size_t k = less.a.size() - 1;
  while (less.i[k] == less.j[k] || less.a[k] == 0) --k;
  std::size_t mirror = 0;
  while (less.i[mirror] != less.j[k] || less.j[mirror] != less.i[k]) ++mirror;
  less.a[k] = less.a[mirror] = 0;
  const Posed other = less.system(less.node_of_dof);
  ASSERT_FALSE(same_pattern(*posed.problem().system, *other.problem().system));
  solver.renew(other.problem().system);
  const Solution c = solver.solve(other.problem().increment, Settings());
  EXPECT_EQ(c.status, Status::converged);
  EXPECT_EQ(c.route, Route::sparse);
  EXPECT_LE(c.iterations, 25);
  // and of the same one, with rows and columns scaled: new factors
  for (std::size_t e = 0; e < less.a.size(); ++e)
    if (less.a[e] < 1e20)
      less.a[e] *= std::exp(std::sin(Real(less.i[e])) + std::sin(Real(less.j[e])));
  const Posed scaled = less.system(less.node_of_dof);
  ASSERT_TRUE(same_pattern(*other.problem().system, *scaled.problem().system));
  solver.renew(scaled.problem().system);
  const Solution d = solver.solve(scaled.problem().increment, Settings());
  EXPECT_EQ(d.route, Route::sparse);
  EXPECT_EQ(d.status, Status::converged);
  EXPECT_LE(d.iterations, 30);
}

TEST(SparseRoute, ComesFirstInThinStripsAlone) {
  const auto answered = [](int d, std::array<int, 3> cells, Real length) {
    SparseOptions o;
    o.d = d;
    o.cells = cells;
    o.size = {length, 1, 1};
    const SceneInBlocks s(o);
    EXPECT_EQ(make_plan(s.posed.problem(), Settings()).route, Route::multigrid) << d << length;
    EXPECT_TRUE(std::isfinite(estimate_costs(*s.system).sparse)) << d << length;
    const Solution a = solve(s.posed.problem(), Settings());
    EXPECT_EQ(a.status, Status::converged) << d << length;
    EXPECT_LE(a.iterations, 30) << d << length;
    return a.layer;
  };
  EXPECT_EQ(answered(2, {225, 2, 1}, 50), Layer::sparse_newton);
  EXPECT_EQ(answered(2, {160, 2, 1}, 20), Layer::sparse_newton);  // many steps on S, where it hangs
  EXPECT_EQ(answered(2, {500, 20, 1}, 25), Layer::multigrid);     // a third of the time
  EXPECT_EQ(answered(3, {90, 2, 2}, 50), Layer::multigrid);       // half
}

TEST(SparseRoute, LeavesFrictionlessBarsThatAreLiftedToTheFactorAtOnce) {
  SparseOptions bar = plate(1);
  bar.cells = {100, 3, 2};
  bar.size = {50, 1, 1};
  bar.law = Law::frictionless;
  SparseScene scene = sparse_block(bar);
  scene.gap.setConstant(1e-3);
  const Posed posed = scene.system(scene.node_of_dof);
  const Plan plan = make_plan(posed.problem(), Settings());
  EXPECT_EQ(plan.route, Route::multigrid);
  EXPECT_TRUE(std::isfinite(plan.costs.path) && std::isinf(plan.costs.sparse));
  const Solution s = solve(posed.problem(), Settings());
  EXPECT_EQ(s.status, Status::converged);
  EXPECT_EQ(s.route, Route::condensed);
  EXPECT_LE(s.steps.total(), 12) << "of multigrid, until the first linear system has shown it";
}

TEST(SparseRoute, TriesNewtonsMethodFirstWhereMultigridHasAnsweredACallBefore) {
  SparseOptions strip;
  strip.d = 2;
  strip.cells = {225, 2, 1};
  strip.size = {50, 1, 1};
  const SceneInBlocks s(strip);
  Solver solver(s.system);
  Settings named{Method::multigrid};
  const Increment& increment = s.posed.problem().increment;
  EXPECT_EQ(solver.solve(increment, named).layer, Layer::multigrid);
  EXPECT_EQ(solver.solve(increment, Settings()).layer, Layer::sparse_newton);
}

TEST(SparseRoute, LeavesWidePlatesToMultigridUnlessTheyAreLifted) {
  SparseScene scene = sparse_block(plate(22));  // far from where its estimates turn
  const Posed lying = scene.system(scene.node_of_dof);
  const Solution a = solve(lying.problem(), Settings());
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.layer, Layer::multigrid);
  scene.gap.setConstant(1e-3);
  const Posed hanging = scene.system(scene.node_of_dof);
  Solver solver(hanging.problem().system);
  const Solution b = solver.solve(hanging.problem().increment, Settings());
  EXPECT_EQ(b.status, Status::converged);
  EXPECT_EQ(b.layer, Layer::sparse_interior_point);
  EXPECT_LE(b.steps.total(), 10);  // of multigrid, until the first linear system has shown it
  const Solution again = solver.solve(hanging.problem().increment, Settings());
  EXPECT_EQ(again.status, Status::converged);
  EXPECT_EQ(again.layer, Layer::sparse_newton);
  EXPECT_EQ(again.steps.total(), 0);  // none of multigrid's
  for (std::size_t e = 0; e < scene.a.size(); ++e)
    if (scene.a[e] < 1e20) scene.a[e] *= 1.01;
  solver.renew(scene.system(scene.node_of_dof).problem().system);
  const Solution stiffer = solver.solve(hanging.problem().increment, Settings());
  EXPECT_EQ(stiffer.status, Status::converged);
  EXPECT_EQ(stiffer.layer, Layer::sparse_newton);
  EXPECT_LE(stiffer.steps.total(), 6);
}
