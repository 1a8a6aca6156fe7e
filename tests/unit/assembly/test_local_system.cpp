#include <gtest/gtest.h>

#include "core/solver.h"
#include "core/threads.h"
#include "unit/driven.h"
#include "unit/refusal.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

Scene small(bool clamp, Real angle = 0) {
  BlockOptions o;
  o.cells = 3;
  o.clamp_side = clamp;
  o.angle = angle;
  return block(o);
}

std::string refusal(const Scene& s) {
  return test::refusal([&] { s.system(); });
}

}  // namespace

TEST(LocalSystem, EnergyIsTheSameInLocalAndGlobalComponents) {
  for (Real angle : {0.0, 0.3, 1.5707963267948966, 2.5}) {
    const Scene s = small(false, angle);
    const Posed system = s.system();
    const Vector u = Vector::Random(s.n);
    Real global = 0;
    for (std::size_t k = 0; k < s.a.size(); ++k) global += u[s.i[k]] * s.a[k] * u[s.j[k]];
    const Vector x = system.to_local(u);
    EXPECT_NEAR(x.dot(system.problem().system->entries() * x), global, 1e-11 * global);
    EXPECT_NEAR((system.to_global(x) - u).norm(), 0, 1e-13);
    EXPECT_NEAR(system.problem().increment.F.dot(x), s.b.dot(u), 1e-12);
  }
}

TEST(LocalSystem, RigidMotionsOfTheScriptDoNoWorkInLocalDofs) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = 2;
    o.angle = 0.4;
    o.axis = {1, 2, 3};
    if (d == 2) o.axis = Eigen::Vector3d::UnitZ();
    const Posed posed = block(o).system();
    const System& system = *posed.problem().system;
    ASSERT_TRUE(system.rigid_modes);
    const Eigen::MatrixXd W = system.rigid_modes();
    ASSERT_EQ(W.rows(), system.dofs());
    ASSERT_EQ(W.cols(), d == 2 ? 3 : 6);
    EXPECT_EQ(W.colPivHouseholderQr().rank(), W.cols());
    EXPECT_LT((system.entries() * W).norm(), 1e-12 * system.entries().norm() * W.norm());
  }
  Scene unknown = small(false);
  unknown.modes.resize(0, 0);
  EXPECT_FALSE(unknown.system().problem().system->rigid_modes);
  const RigidModes short_by_one = [n = unknown.n] {
    return Eigen::MatrixXd(Eigen::MatrixXd::Ones(n - 1, 3));
  };
  const LocalSystem other(unknown.triplets(), 2, unknown.points, {}, {short_by_one});
  EXPECT_EQ(other.system()->rigid_modes().size(), 0);  // of another number of dofs: as none
}

TEST(LocalSystem, IsTheSameOnAnyNumberOfThreads) {
  Scene s;
  s.n = 20000;
  for (Index step : {0, 1, 100, 1}) {  // one place twice
    for (Index i = 0; i + step < s.n; ++i) {
      const Index way = (7919 * i) % (s.n - step);  // in no order
      const Real a = step == 0 ? 10 + std::sin(way) : std::cos(way + step);
      for (int half = 0; half < (step == 0 ? 1 : 2); ++half) {
        s.i.push_back(half == 0 ? way : way + step);
        s.j.push_back(half == 0 ? way + step : way);
        s.a.push_back(a);
      }
    }
  }
  EntryList all;
  for (std::size_t k = 0; k < s.a.size(); ++k) all.emplace_back(s.i[k], s.j[k], s.a[k]);
  const Matrix whole = sparse(s.n, s.n, all);
  for (Index threads : {1, 2, 3}) {
    const Threads given(threads);
    const LocalSystem local(s.triplets(), 2, {});
    const Matrix& A = local.system()->entries();
    ASSERT_EQ(A.nonZeros(), whole.nonZeros());
    EXPECT_TRUE(
        std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), whole.innerIndexPtr()));
    EXPECT_TRUE(std::equal(A.valuePtr(), A.valuePtr() + A.nonZeros(), whole.valuePtr()));
  }
}

TEST(LocalSystem, RotatesOnlyWhereNormalsLeaveTheAxes) {
  EXPECT_FALSE(small(false).system().rotated());
  EXPECT_TRUE(small(false, 0.3).system().rotated());
}

TEST(LocalSystem, RowsAreSortedWithoutDuplicates) {
  const Posed system = small(false, 0.3).system();
  const Matrix& A = system.problem().system->entries();
  for (Index i = 0; i < A.rows(); ++i)
    for (Index k = A.outerIndexPtr()[i] + 1; k < A.outerIndexPtr()[i + 1]; ++k)
      EXPECT_LT(A.innerIndexPtr()[k - 1], A.innerIndexPtr()[k]);
}

TEST(LocalSystem, HalfStorageAndUnsortedTripletsGiveTheSameMatrix) {
  Scene s = small(true);
  const Matrix A = s.system().problem().system->entries();
  std::vector<std::size_t> order(s.a.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  Scene lower = s;
  lower.i.clear(), lower.j.clear(), lower.a.clear();
  for (std::size_t k : order)
    if (s.i[k] >= s.j[k]) {
      lower.i.push_back(s.i[k] + 1);
      lower.j.push_back(s.j[k] + 1);
      lower.a.push_back(s.a[k]);
    }
  Triplets t = lower.triplets();
  t.base = 1;
  t.half = true;
  LocalSystem system(t, 2, s.points);
  EXPECT_EQ((system.system()->entries() - A).norm(), 0);
}

TEST(LocalSystem, DirichletDataComeFromHugeDiagonalsAndFromUnitRowsAlike) {
  BlockOptions o;
  o.clamp_side = true;
  Scene huge = block(o);
  o.tgv_minus_one = true;
  Scene unit = block(o);
  for (std::size_t k = 0; k < huge.a.size(); ++k)
    if (huge.a[k] == 1e30) {
      huge.b[huge.i[k]] = 1e30 * 0.25;
      unit.b[huge.i[k]] = 0.25;
    }
  const Posed from_huge = huge.system(), from_unit = unit.system();
  EXPECT_EQ(from_huge.fixed_dofs(), 5);
  EXPECT_EQ(from_unit.fixed_dofs(), 5);
  EXPECT_EQ((from_huge.problem().system->entries() - from_unit.problem().system->entries()).norm(),
            0);
  EXPECT_NEAR((from_huge.problem().increment.F - from_unit.problem().increment.F).norm(), 0, 1e-12);
  EXPECT_NEAR(from_huge.to_global(Vector::Zero(from_huge.problem().dofs())).maxCoeff(), 0.25,
              1e-15);
}

TEST(LocalSystem, ZeroedColumnsWithDataAreRefused) {
  BlockOptions o;
  o.clamp_side = o.tgv_minus_one = true;
  Scene s = block(o);
  std::vector<char> unit(s.n, 0);
  Index fixed = -1;
  for (std::size_t k = 0; k < s.a.size(); ++k)
    if (s.a[k] == 1 && s.i[k] == s.j[k]) unit[fixed = s.i[k]] = 1;
  for (std::size_t k = 0; k < s.a.size(); ++k)
    if (s.i[k] != s.j[k] && unit[s.j[k]]) s.a[k] = 0;
  EXPECT_EQ(refusal(s), "");
  s.b[fixed] = 0.1;
  EXPECT_TRUE(names(refusal(s), "tgv=-2"));
}

TEST(LocalSystem, AsymmetryNaNAndZeroDiagonalsAreRefusedByName) {
  Scene s = small(false);
  const Scene good = s;
  s.entry(2, 0) += 1;
  EXPECT_TRUE(names(refusal(s), "must be symmetric"));
  s = good;
  s.entry(2, 0) = std::nan("");
  EXPECT_TRUE(names(refusal(s), "A(2,0) = "));
  s = good;
  s.entry(4, 4) = 0;
  EXPECT_TRUE(names(refusal(s), "A(4,4) = 0"));
  EXPECT_EQ(refusal(good), "");
}

TEST(LocalSystem, ANodeOnASymmetryPlaneKeepsOneDirection) {
  const Scene s = small(true);
  const Posed system = s.system();
  const ContactProblem& p = system.problem();
  EXPECT_EQ(p.nodes(), 4);
  EXPECT_EQ(p.tangents(0), 1);
  EXPECT_EQ(p.tangents(3), 0);  // u_x = 0 there
}

TEST(LocalSystem, AFrictionlessNodeLeavesItsTangentToTheInterior) {
  Scene s = small(false);
  s.law = Law::frictionless;
  for (ContactPoint& p : s.points) p.friction = false;
  const Posed system = s.system();
  EXPECT_EQ(system.problem().contact_dofs(), system.nodes());
}

TEST(LocalSystem, AnObliqueNormalOnAHalfFixedNodeIsProjected) {
  Scene s = small(true);
  s.points[3].normal = {std::sqrt(0.5), -std::sqrt(0.5), 0};
  s.gap.setConstant(0.1);
  const Posed system = s.system();
  // only u_y is free: w_N = -u_y/sqrt(2) <= 0.1
  const Index N = system.problem().system->first[3];
  EXPECT_NEAR(system.problem().increment.gap[3], 0.1, 1e-14);
  EXPECT_NEAR(system.to_global(Vector::Unit(system.problem().dofs(), N))[s.points[3].dof[1]],
              -std::sqrt(2.0), 1e-14);
}

TEST(LocalSystem, TheForceOnTheBodyIsMinusTheResidualOnContactNodesOnly) {
  const Scene s = small(false, 0.4);
  const Posed system = s.system();
  const Vector r = Vector::Random(system.problem().dofs());
  const Vector f = system.force_to_global(r);
  EXPECT_NEAR(f.norm(), r.tail(system.problem().contact_dofs()).norm(), 1e-13);
}

TEST(LocalSystem, VectorsOfAnotherSizeAreRefused) {
  const Scene s = small(true);
  const Posed system = s.system();
  const auto refused = [&](const Vector& b, const Vector& u_old, const PointLaws& laws) {
    return test::refusal([&] { system.local().increment(b, u_old, laws); });
  };
  EXPECT_EQ(refused(s.b, {}, s.laws()), "");
  EXPECT_TRUE(names(refused(Vector::Zero(3), {}, s.laws()), "b has 3 values"));
  EXPECT_TRUE(names(refused(s.b, Vector::Zero(1), s.laws()), "u_old has 1"));
  EXPECT_TRUE(names(refused(s.b, {}, {Law::coulomb, false, {}, s.friction, {}}), "gap has 0"));
  EXPECT_TRUE(names(refused(s.b, {}, {Law::coulomb, false, s.gap, {}, {}}), "mu has 0"));
  EXPECT_TRUE(names(refused(s.b, {}, {Law::tresca, false, s.gap, {}, {}}), "g has 0"));
  EXPECT_EQ(refused(s.b, {}, {Law::frictionless, false, s.gap, {}, {}}), "");
}

TEST(LocalSystem, AnEntryWithoutItsMirrorImageIsRefusedWhereverItStands) {
  const Scene good = small(false);
  for (std::size_t k = 0; k < good.a.size(); ++k) {
    if (good.i[k] == good.j[k] || std::abs(good.a[k]) < 1e-6) continue;
    Scene s = good;
    s.i.erase(s.i.begin() + Index(k));
    s.j.erase(s.j.begin() + Index(k));
    s.a.erase(s.a.begin() + Index(k));
    EXPECT_TRUE(names(refusal(s), "must be symmetric")) << good.i[k] << " " << good.j[k];
  }
}

TEST(LocalSystem, RowsOfAPartThatAreNotWholeAreNotChecked) {
  const auto refusal_of_part = [](const Scene& s, Index row) {
    std::vector<char> whole(s.n, 1);
    whole[row] = 0;
    Triplets A = s.triplets();
    A.whole = whole.data();
    return test::refusal([&] { LocalSystem(A, 2, {}, {}); });
  };
  Scene s = small(false);
  s.entry(2, 0) += 1;
  s.entry(2, 2) = 1e-170;
  EXPECT_EQ(refusal_of_part(s, 2), "");
  EXPECT_TRUE(names(refusal_of_part(s, 4), "A(2,2) = 1e-170; a stiffness"));
  s = small(false);
  s.entry(2, 0) += 1;
  EXPECT_EQ(refusal_of_part(s, 0), "");
  EXPECT_TRUE(names(refusal_of_part(s, 4), "must be symmetric"));
}

TEST(LocalSystem, TheStateOfALoadMayBeGivenInLocalDofs) {
  const Scene s = small(false, 0.3);
  const LocalSystem system(s.triplets(), 2, s.points);
  const Vector u = Vector::LinSpaced(s.n, -1, 2);
  const Vector F = system.load_from(s.b, system.to_local(u)).F;
  EXPECT_EQ(F, system.increment(s.b, u, s.laws()).increment.F);
  EXPECT_NE(F, system.increment(s.b, {}, s.laws()).increment.F);
}

TEST(LocalSystem, TheRoundingOfALoadIsThatOfTheTermsItIsSummedOf) {
  BlockOptions o;
  const auto rounding = [&](Real far) {
    return brought_from_far(o, far).system().problem().increment.rounding;
  };
  EXPECT_GT(rounding(1), 0);
  EXPECT_NEAR(rounding(1000) / rounding(1), 1000, 10);
  Scene s = small(true);
  const LocalSystem local(s.triplets(), 2, s.points);
  const Real at_rest = local.increment(s.b, {}, s.laws()).increment.rounding;
  const Vector far = Vector::Constant(s.n, 1e3);  // A uold nearly cancels
  EXPECT_GT(local.increment(s.b, far, s.laws()).increment.rounding, 1e3 * at_rest);
}

TEST(LocalSystem, ALoadWhoseSquaresVanishIsNoRounding) {
  for (Real size : {1e-100, 1e-200}) {
    Scene s = block(BlockOptions());
    s.b *= size;
    const Posed posed = s.system();
    EXPECT_FALSE(posed.problem().increment.F.isZero(0)) << size;
    EXPECT_THROW(solve(posed.problem(), Settings()), IllegalInput) << size;
  }
}

TEST(LocalSystem, WhatVanishesOfADisplacementIsNothingWhereNothingActs) {
  BlockOptions o;
  o.pressure = o.shear = 0;
  Scene s = block(o);
  s.gap.setZero();
  const Posed posed = s.system();
  const LocalSystem& local = posed.local();
  for (Real size : {1e-40, 1e-90}) {
    const Increment rest =
        local.increment(s.b, Vector::LinSpaced(s.n, 0, size), s.laws()).increment;
    EXPECT_EQ(rest.F.isZero(0), size < 1e-80);
    EXPECT_EQ(rest.gap.isZero(0), size < 1e-80);
    EXPECT_EQ(solve({local.system(), rest}, Settings()).status, Status::converged);
  }
  s.b[0] = 1e-90;  // a load is not taken off
  EXPECT_FALSE(local.increment(s.b, {}, s.laws()).increment.F.isZero(0));
}

TEST(LocalSystem, ALoadThatAlreadyActsKeepsItsScaleInTheNextIncrement) {
  const Scene s = small(true);
  const LocalSystem local(s.triplets(), 2, s.points);
  const LocalIncrement first = local.increment(s.b, {}, s.laws());
  const Solution a = solve({local.system(), first.increment}, Settings());
  const Vector halfway = local.to_global(a.x / 2, first.u0);
  const Increment again = local.increment(s.b, halfway, s.laws()).increment;
  EXPECT_LT(norm_D(*local.system(), again.F), first.increment.force_scale);
  EXPECT_NEAR(again.force_scale, first.increment.force_scale, 1e-12 * first.increment.force_scale);
  const Vector w = local.to_local(halfway);
  for (Index k = 0; k < local.nodes(); ++k)
    EXPECT_NEAR(again.gap[k], s.gap[k] - w[local.system()->first[k]], 1e-15);
}
