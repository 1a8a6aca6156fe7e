// The central path alone, and as the layer that answers where active sets do not settle.
#include <gtest/gtest.h>

#include "../random_scene.h"
#include "../sparse_scene.h"
#include "../statics.h"
#include "../verifier.h"
#include "newtons_answer.h"
#include "core/condensed/interior_point.h"
#include "core/solver.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// A strip 100 times as long as thick, held at one end, pressed onto a floor and lifted at the
/// other end.
SparseScene lifted(int cells, Law law, Real mu) {
  SparseOptions o;
  o.d = 2;
  o.cells = {cells, 2, 1};
  o.size = {1, 0.01, 1};
  o.law = law;
  o.mu = mu;
  o.pressure = 1e-3;
  o.shear = 0;
  SparseScene s = sparse_block(o);
  Index tip = 0;
  for (Index i = 0; i < s.position.rows(); ++i)
    if (s.position.row(i).sum() > s.position.row(tip).sum()) tip = i;
  s.b[2 * tip + 1] += 2e-4;
  return s;
}

}  // namespace

TEST(InteriorPoint, TheEndOfThePathObeysTheLawsBeforeNewtonsMethod) {
  for (int d : {2, 3})
    for (Law law : {Law::frictionless, Law::tresca, Law::coulomb}) {
      OnContact condensed(block(sheared_at_side(d, law)));
      CentralPath path(condensed.problem());
      const Index steps = path.follow(100);
      EXPECT_GT(steps, 3) << d << int(law);
      EXPECT_LE(steps, 25) << d << int(law);
      EXPECT_LT(condensed.residual(path.x()), 1e-4) << d << int(law);
    }
}

TEST(InteriorPoint, ItsAnswerIsNewtonsWhereBothArrive) {
  expect_newtons_answer([](const CondensedProblem& p) { return by_interior_point(p, 100); }, 1e-10);
}

TEST(InteriorPoint, HoldsLaddersByFrictionAlone) {
  for (const auto& [degrees, floor, wall] :
       {std::tuple{60., 0.3, 0.2}, {40., 0.6, 0.2}, {65., 0.2, 0.2}, {50., 0.4, 0.2}}) {
    OnContact condensed(ladder(degrees, floor, wall));
    const Attempt a = by_interior_point(condensed.problem(), 1000);
    ASSERT_TRUE(a.solved) << degrees;
    EXPECT_LE(a.steps, 40) << degrees;
    EXPECT_LT(condensed.residual(a.x), 1e-8) << degrees;
  }
}

TEST(InteriorPoint, KeepsToItsBoundAndLeavesBilateralContactAlone) {
  BlockOptions o;
  o.clamp_side = true;
  OnContact condensed(block(o));
  for (Index bound : {0, 1, 7}) {
    const Attempt a = by_interior_point(condensed.problem(), bound);
    EXPECT_LE(a.steps, bound);
    EXPECT_FALSE(a.solved);
  }
  ContactProblem bilateral = condensed.posed.problem();
  bilateral.increment.bilateral = true;
  const CondensedProblem all = condensed.problem();
  const CondensedProblem p{all.S, all.f, all.D, bilateral};
  EXPECT_EQ(by_interior_point(p, 100).steps, 0);
}

TEST(InteriorPoint, AnswersForStripsOnAFloorInAsManyStepsWhateverTheirMesh) {
  for (int cells : {50, 100, 200})
    for (Real mu : {0., 0.2}) {
      const Scene s = lifted(cells, mu > 0 ? Law::coulomb : Law::frictionless, mu);
      const Posed posed = s.system();
      const Solution a = solve(posed.problem(), Settings());
      EXPECT_EQ(a.status, Status::converged) << cells << " " << mu;
      EXPECT_EQ(a.layer, Layer::interior_point) << cells << " " << mu;
      EXPECT_LE(a.iterations, mu > 0 ? 20 : 18) << cells << " " << mu;
      const auto verdict = verify(s, posed.to_global(a.x), posed.force_to_global(a.certificate.r));
      EXPECT_LT(verdict.worst(), 1e-5) << cells << " " << mu;
    }
}

TEST(InteriorPoint, GapsOutOfReachAreAsGoodAsNearOnes) {
  for (Real mu : {0., 0.2}) {
    SparseScene s = lifted(200, mu > 0 ? Law::coulomb : Law::frictionless, mu);
    const Solution near = solve(s.system().problem(), Settings());
    for (std::size_t k = 0; k < s.points.size(); ++k)
      if (s.position(s.points[k].dof[0] / 2, 0) > 0.8) s.gap[static_cast<Index>(k)] = 1e3;
    const Solution far = solve(s.system().problem(), Settings());
    EXPECT_EQ(far.status, Status::converged) << mu;
    EXPECT_EQ(far.layer, Layer::interior_point) << mu;
    EXPECT_LE(far.iterations, 70) << mu;
    EXPECT_LT((far.x - near.x).norm(), 1e-7 * near.x.norm()) << mu;
  }
}

TEST(InteriorPoint, CohesionAndCapsAddFewSteps) {
  for (int cells : {50, 100})
    for (const auto& [cohesion, cap] : {std::pair{1., 1e300}, {0., 0.05}, {10., 5.}}) {
      Scene s = lifted(cells, Law::coulomb, 0.2);
      const Index m = static_cast<Index>(s.points.size());
      s.cohesion = Vector::Constant(m, cohesion * 1e-3 / cells);
      s.cap = Vector::Constant(m, cap * 1e-3 / cells);
      const Posed posed = s.system();
      const Solution a = solve(posed.problem(), Settings());
      EXPECT_EQ(a.status, Status::converged) << cells << " " << cohesion << " " << cap;
      EXPECT_EQ(a.layer, Layer::interior_point) << cells << " " << cohesion << " " << cap;
      EXPECT_LE(a.iterations, 35) << cells << " " << cohesion << " " << cap;
      const auto verdict = verify(s, posed.to_global(a.x), posed.force_to_global(a.certificate.r));
      EXPECT_LT(verdict.worst(), 1e-5) << cells << " " << cohesion << " " << cap;
    }
}

TEST(InteriorPoint, MultigridGivesWayToItWhereTheFacesOfAStripRunAway) {
  const Scene s = lifted(400, Law::coulomb, 0.2);
  const Posed posed = s.system(mesh_nodes(s));
  ASSERT_EQ(make_plan(posed.problem(), Settings()).route, Route::multigrid);
  const Solution a = solve(posed.problem(), Settings());
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.layer, Layer::sparse_interior_point);
  EXPECT_LE(a.iterations, 20 + 20);  // its cycles until then, and the steps
}

TEST(InteriorPoint, HoldsNearlyIncompressibleBlocksByFriction) {
  SparseOptions o;
  o.cells = {6, 6, 6};
  o.nu = 0.4999;
  o.clamp_side = false;
  for (Real mu : {0.5, 0.9}) {
    o.mu = mu;
    const Posed posed = sparse_block(o).system();
    const Solution a = solve(posed.problem(), Settings());
    EXPECT_EQ(a.status, Status::converged) << mu;
    EXPECT_LE(a.iterations, 60) << mu;
  }
}

TEST(InteriorPoint, APathThatStandsStillIsLeftWithoutNewtonsMethod) {
  for (unsigned seed : {490, 1794, 2193, 2699}) {
    OnContact condensed(make_scene(random_recipe(seed)));
    const CondensedProblem p = condensed.problem();
    CentralPath path(p);
    const Index steps = path.follow(100);
    ASSERT_TRUE(path.stalled()) << seed;
    const Attempt a = by_interior_point(p, 100);
    EXPECT_FALSE(a.solved) << seed;
    EXPECT_EQ(a.steps, steps) << seed;
    EXPECT_TRUE(by_proximal_points(p, 1000).solved) << seed;
  }
  OnContact condensed(block(sheared_at_side(3)));
  CentralPath path(condensed.problem());
  path.follow(100);
  EXPECT_FALSE(path.stalled());
}
