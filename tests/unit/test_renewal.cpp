// Another matrix in the place of the last: what holds is kept, and the answer is that of a first
// call.
#include <gtest/gtest.h>

#include "core/condensed/elimination.h"
#include "core/solver.h"
#include "sparse_scene.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

Solution solved(Solver& solver, const Posed& posed, Method method) {
  Settings settings{method};
  settings.tol = 1e-10;
  return solver.solve(posed.problem().increment, settings);
}

/// A scene as LocalSystem takes it, after another.
std::unique_ptr<LocalSystem> posed_after(const SparseScene& s, const LocalSystem* before) {
  const BodyShape shape{[M = s.modes] { return M; }};
  return std::make_unique<LocalSystem>(s.triplets(), s.d, s.points, s.node_of_dof, shape, before);
}

/// An entry between two free dofs of the interior, and its mirror image.
std::pair<std::size_t, std::size_t> coupling(const SparseScene& s) {
  const Index far = s.n - 3;
  std::size_t k = 0, mirror = 0;
  while (s.i[k] != far || s.j[k] == far || s.a[k] == 0) ++k;
  while (s.i[mirror] != s.j[k] || s.j[mirror] != far) ++mirror;
  return {k, mirror};
}

Real difference(const Matrix& A, const Matrix& B) { return Matrix(A - B).norm() / B.norm(); }

}  // namespace

TEST(Renewal, HasTheAnswerOfAFirstCallByEveryRoute) {
  for (int d : {2, 3})
    for (Method method : {Method::condensed, Method::multigrid, Method::gcx}) {
      SparseOptions o = cube_of(d == 2 ? 12 : 6, d);
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
  const SparseScene one = sparse_block(cube_of(8, 2)), other = sparse_block(cube_of(6, 2));
  const Posed posed = one.system(one.node_of_dof), next = other.system(other.node_of_dof);
  EXPECT_FALSE(same_dofs(*posed.problem().system, *next.problem().system));
  for (Method method : {Method::automatic, Method::multigrid}) {
    Solver solver(posed.problem().system);
    solved(solver, posed, method);
    solver.renew(next.problem().system);
    EXPECT_EQ(solver.memory_needed(), 0);
    EXPECT_EQ(solved(solver, next, method).status, Status::converged);
  }
  AssembledSystem system = assembled(posed.problem().system);
  EXPECT_TRUE(same_dofs(*posed.problem().system, system));
  std::swap(system.mesh_node[0], system.mesh_node[4]);
  EXPECT_FALSE(same_dofs(*posed.problem().system, system));
  system = assembled(posed.problem().system);
  system.first.erase(system.first.begin() + 1);
  EXPECT_FALSE(same_dofs(*posed.problem().system, system));
}

TEST(Renewal, TheFactorTakesNewValuesOverTheLayoutOfTheSamePattern) {
  SparseOptions o = cube_of(20, 2);
  const SparseScene one = sparse_block(o);
  o.nu = 0.45;
  const SparseScene other = sparse_block(o);
  const Posed posed = one.system(one.node_of_dof), next = other.system(other.node_of_dof);
  ASSERT_TRUE(same_pattern(*posed.problem().system, *next.problem().system));
  Elimination kept, fresh;
  kept.factor(*posed.problem().system, 1e9);
  EXPECT_EQ(kept.factor(*next.problem().system, 1e9), Elimination::Outcome::done);
  fresh.factor(*next.problem().system, 1e9);
  EXPECT_EQ((kept.S() - fresh.S()).norm(), 0);
  EXPECT_EQ(kept.take_times().order, 0);
  EXPECT_GT(fresh.take_times().order, 0);
}

TEST(Renewal, AnotherPatternOnTheSameDofsIsLaidOutAnew) {
  const SparseScene scene = sparse_block(cube_of(8, 2));
  SparseScene sprung = scene;  // by springs from end to end, outside of any factor's pattern
  std::vector<Real> diagonal(scene.n, 0);
  for (std::size_t e = 0; e < scene.a.size(); ++e)
    if (scene.i[e] == scene.j[e]) diagonal[scene.i[e]] += scene.a[e];
  for (Index k = 0, l = scene.n - 1; k < l; ++k, --l) {
    if (std::max(diagonal[k], diagonal[l]) > 1e20) continue;
    for (const Index p : {k, l})
      for (const Index q : {k, l}) {
        sprung.i.push_back(p);
        sprung.j.push_back(q);
        sprung.a.push_back(p == q ? 1 : -1);
      }
  }
  const Posed without = scene.system(scene.node_of_dof), with = sprung.system(scene.node_of_dof);
  ASSERT_TRUE(same_dofs(*without.problem().system, *with.problem().system));
  ASSERT_FALSE(same_pattern(*without.problem().system, *with.problem().system));
  Solver solver(without.problem().system), first(with.problem().system);
  solved(solver, without, Method::condensed);
  for (int k = 0; k < 2; ++k) solver.renew(with.problem().system);  // what was laid out is older
  const Solution a = solved(solver, with, Method::condensed),
                 b = solved(first, with, Method::condensed);
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.layer, b.layer);
  EXPECT_EQ(a.x, b.x);
}

TEST(Renewal, AMatrixThatHadNoFactorIsFollowedByOneThatHas) {
  const SparseScene scene = sparse_block(cube_of(8, 2));
  SparseScene bad = scene;
  const auto [k, mirror] = coupling(scene);
  bad.a[k] = bad.a[mirror] = 1e4 * scene.a[k];
  const Posed indefinite = bad.system(bad.node_of_dof), good = scene.system(scene.node_of_dof);
  Solver solver(indefinite.problem().system), first(good.problem().system);
  EXPECT_NE(solved(solver, indefinite, Method::automatic).status, Status::converged);
  solver.renew(good.problem().system);
  const Solution a = solved(solver, good, Method::automatic),
                 b = solved(first, good, Method::automatic);
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_EQ(a.layer, b.layer);
  EXPECT_GT(a.times.factor, 0);
}

TEST(Renewal, WhatOneMatrixLeavesFreeAnotherMayHold) {
  SparseOptions o = cube_of(6, 2);
  o.clamp_side = false;
  o.shear = 0;
  o.mu = 0;
  o.law = Law::frictionless;
  const SparseScene scene = sparse_block(o);
  SparseScene bedded = scene;
  for (std::size_t k = 0; k < bedded.a.size(); ++k)
    if (bedded.i[k] == bedded.j[k]) bedded.a[k] *= 1.01;
  const Posed loose = scene.system(scene.node_of_dof), held = bedded.system(bedded.node_of_dof);
  for (Method method : {Method::condensed, Method::multigrid, Method::gcx}) {
    Solver solver(loose.problem().system);
    EXPECT_EQ(solved(solver, loose, method).undetermined.cols(), 1);
    solver.renew(held.problem().system);
    EXPECT_EQ(solved(solver, held, method).undetermined.cols(), 0);
  }
}

TEST(Renewal, AMatrixIsFilledOverThePatternThatHoldsIt) {
  for (int d : {2, 3}) {
    SparseOptions o = cube_of(4, d);
    o.tilt = 0.2;  // frames that are turned
    SparseScene scene = sparse_block(o);
    const auto first = posed_after(scene, nullptr);
    for (Real& a : scene.a)
      if (a < 1e20) a *= 2;
    const auto second = posed_after(scene, first.get());
    EXPECT_TRUE(same_pattern(*first->system(), *second->system()));
    EXPECT_LT(difference(second->system()->entries(),
                         scene.system(scene.node_of_dof).problem().system->entries()),
              1e-14);
  }
}

TEST(Renewal, EntriesOutsideThePatternMakeAnotherWhichThenStays) {
  SparseScene scene = sparse_block(cube_of(6, 2));
  const std::vector<Real> whole = scene.a;
  const auto [k, mirror] = coupling(scene);
  scene.a[k] = scene.a[mirror] = 0;
  const auto without = posed_after(scene, nullptr);
  scene.a = whole;
  const auto with = posed_after(scene, without.get());
  EXPECT_FALSE(same_pattern(*without->system(), *with->system()));
  EXPECT_LT(difference(with->system()->entries(),
                       scene.system(scene.node_of_dof).problem().system->entries()),
            1e-14);
  scene.a[k] = scene.a[mirror] = 0;
  const auto again = posed_after(scene, with.get());
  EXPECT_TRUE(same_pattern(*again->system(), *with->system()));
  EXPECT_LT(difference(again->system()->entries(), without->system()->entries()), 1e-14);
}

TEST(Renewal, TripletsInAnotherOrderGiveTheSameMatrix) {
  SparseScene scene = sparse_block(cube_of(6, 2));
  const auto first = posed_after(scene, nullptr);
  std::reverse(scene.i.begin(), scene.i.end());
  std::reverse(scene.j.begin(), scene.j.end());
  std::reverse(scene.a.begin(), scene.a.end());
  const auto second = posed_after(scene, first.get());
  EXPECT_TRUE(same_pattern(*first->system(), *second->system()));
  EXPECT_LT(difference(second->system()->entries(), first->system()->entries()), 1e-14);
}
