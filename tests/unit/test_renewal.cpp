// Another matrix in the place of the last: what holds is kept, and the answer is that of a first
// call.
#include <gtest/gtest.h>

#include "core/condensed/cholmod_elimination.h"
#include "core/solver.h"
#include "sparse_scene.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

SparseOptions options(int d, int cells) {
  SparseOptions o;
  o.d = d;
  o.cells = {cells, cells, cells};
  return o;
}

Solution solved(Solver& solver, const Posed& posed, Method method) {
  Settings settings;
  settings.method = method;
  settings.tol = 1e-10;
  return solver.solve(posed.problem().increment, settings);
}

/// A scene as LocalSystem takes it, for a matrix that may come again.
std::unique_ptr<LocalSystem> renewable(const SparseScene& s, const LocalSystem* before = nullptr) {
  return std::make_unique<LocalSystem>(
      s.triplets(), s.d, s.points, s.node_of_dof, [M = s.modes] { return M; },
      Renewal{true, before});
}

Real difference(const Matrix& A, const Matrix& B) { return Matrix(A - B).norm() / B.norm(); }

}  // namespace

TEST(Renewal, HasTheAnswerOfAFirstCallByEveryRoute) {
  for (int d : {2, 3})
    for (Method method : {Method::condensed, Method::multigrid, Method::gcx}) {
      SparseOptions o = options(d, d == 2 ? 12 : 6);
      SparseScene scene = sparse_block(o);
      Posed posed = scene.system(scene.node_of_dof);
      Solver solver(posed.problem().system);
      solved(solver, posed, method);
      for (Real nu : {0.2, 0.4}) {
        o.nu = nu;
        const SparseScene other = sparse_block(o);
        const Posed next = other.system(other.node_of_dof);
        solver.renew(next.problem().system);
        const Solution a = solved(solver, next, method);
        Solver first(next.problem().system);
        const Solution b = solved(first, next, method);
        EXPECT_EQ(a.status, Status::converged);
        EXPECT_EQ(a.layer, b.layer);
        EXPECT_LT((a.x - b.x).norm(), 1e-7 * b.x.norm()) << d;
      }
    }
}

TEST(Renewal, OtherContactNodesAreAnotherScene) {
  const SparseScene one = sparse_block(options(2, 8)), other = sparse_block(options(2, 6));
  const Posed posed = one.system(one.node_of_dof), next = other.system(other.node_of_dof);
  EXPECT_FALSE(same_dofs(*posed.problem().system, *next.problem().system));
  Solver solver(posed.problem().system);
  solved(solver, posed, Method::automatic);
  solver.renew(next.problem().system);
  EXPECT_EQ(solved(solver, next, Method::automatic).status, Status::converged);
}

TEST(Renewal, TheFactorTakesNewValuesOverTheLayoutOfTheSamePattern) {
  SparseOptions o = options(2, 20);
  const SparseScene one = sparse_block(o);
  o.nu = 0.45;
  const SparseScene other = sparse_block(o);
  const Posed posed = one.system(one.node_of_dof), next = other.system(other.node_of_dof);
  ASSERT_TRUE(same_pattern(*posed.problem().system, *next.problem().system));
  CholmodElimination kept, fresh;
  kept.factor(*posed.problem().system, 1e9);
  EXPECT_EQ(kept.factor(*next.problem().system, 1e9, true), Elimination::Outcome::done);
  fresh.factor(*next.problem().system, 1e9);
  EXPECT_EQ((kept.S() - fresh.S()).norm(), 0);
  EXPECT_LT(kept.times().order, fresh.times().order);
}

TEST(Renewal, AMatrixIsFilledOverThePatternThatHoldsIt) {
  for (int d : {2, 3}) {
    SparseOptions o = options(d, 4);
    o.tilt = 0.2;  // frames that are turned
    SparseScene scene = sparse_block(o);
    const auto first = renewable(scene);
    for (Real& a : scene.a)
      if (a < 1e20) a *= 2;
    const auto second = renewable(scene, first.get());
    EXPECT_TRUE(same_pattern(*first->system(), *second->system()));
    EXPECT_LT(difference(second->system()->entries(),
                         scene.system(scene.node_of_dof).problem().system->entries()),
              1e-14);
  }
}

TEST(Renewal, EntriesOutsideThePatternMakeAnotherWhichThenStays) {
  SparseScene scene = sparse_block(options(2, 6));
  std::vector<Real> whole = scene.a;
  std::size_t k = 0;  // an entry between two free dofs of the interior, and its mirror image
  const Index far = scene.n - 3;
  while (scene.i[k] != far || scene.j[k] == far || whole[k] == 0) ++k;
  std::size_t mirror = 0;
  while (scene.i[mirror] != scene.j[k] || scene.j[mirror] != far) ++mirror;
  scene.a[k] = scene.a[mirror] = 0;
  const auto without = renewable(scene);
  scene.a = whole;
  const auto with = renewable(scene, without.get());
  EXPECT_FALSE(same_pattern(*without->system(), *with->system()));
  EXPECT_LT(difference(with->system()->entries(),
                       scene.system(scene.node_of_dof).problem().system->entries()),
            1e-14);
  scene.a[k] = scene.a[mirror] = 0;
  const auto again = renewable(scene, with.get());
  EXPECT_TRUE(same_pattern(*again->system(), *with->system()));
  EXPECT_LT(difference(again->system()->entries(), without->system()->entries()), 1e-14);
}

TEST(Renewal, TripletsInAnotherOrderGiveTheSameMatrix) {
  SparseScene scene = sparse_block(options(2, 6));
  const auto first = renewable(scene);
  std::reverse(scene.i.begin(), scene.i.end());
  std::reverse(scene.j.begin(), scene.j.end());
  std::reverse(scene.a.begin(), scene.a.end());
  const auto second = renewable(scene, first.get());
  EXPECT_TRUE(same_pattern(*first->system(), *second->system()));
  EXPECT_LT(difference(second->system()->entries(), first->system()->entries()), 1e-14);
}
