// Rigid motions that nothing determines: named, and the field with the least of them returned.
#include <gtest/gtest.h>

#include "bodies.h"
#include "core/statics/rigid_motions.h"
#include "core/statics/undetermined.h"
#include "core/linear_algebra.h"
#include "core/solver.h"
#include "core/statics/floating.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// Solves, and expects so many motions, none of which x has a part along.
Solution expect_undetermined(const ContactProblem& p, Index count, const Settings& by = Settings(),
                             Real residual = 1e-10) {
  const Solution s = solve(p, by);
  EXPECT_EQ(s.status, Status::converged);
  EXPECT_LT(s.certificate.residual, residual);
  EXPECT_EQ(s.undetermined.cols(), count);
  if (s.undetermined.cols() == 0) return s;
  const Vector part = s.undetermined.transpose() * p.system->D.cwiseProduct(s.x);
  const Real size = std::sqrt(s.x.dot(p.system->D.cwiseProduct(s.x)));
  for (Index k = 0; k < part.size(); ++k) {
    const Vector v = s.undetermined.col(k);
    EXPECT_LT(std::abs(part[k]), 1e-9 * size * std::sqrt(v.dot(p.system->D.cwiseProduct(v))));
    EXPECT_LT((p.system->entries() * v).norm(), 1e-9 * (p.system->entries() * s.x).norm() / size);
  }
  return s;
}

struct Way {
  std::string name;
  Settings settings;
  Layer layer;
};

/// Every method on A itself; auto without the memory for a factor among them.
std::vector<Way> ways_on_A() {
  std::vector<Way> ways;
  const auto add = [&](const char* name, Method method, Layer layer, double memory) {
    Settings s;
    s.method = method;
    s.memory = memory;
    ways.push_back({name, s, layer});
  };
  add("GC1", Method::gc1, Layer::gc, 8e9);
  add("GC2", Method::gc2, Layer::gc, 8e9);
  add("GC3", Method::gc3, Layer::gc, 8e9);
  add("GCX", Method::gcx, Layer::gcx, 8e9);
  add("SORP", Method::sorp, Layer::sorp, 8e9);
  add("auto without memory", Method::automatic, Layer::gcx, 10);
  return ways;
}

/// A body that is pressed and rubbed, and one without a load, its bottom at the gap.
ContactProblem above_the_obstacle(Real gap) {
  BlockOptions o;
  o.cells = 3;
  ContactProblem p = beside(problem_of(o), 2);
  const Index n = p.dofs() / 2, I = p.interior() / 2;
  p.increment.F.segment(I, I).setZero();
  p.increment.F.tail(n - I).setZero();
  p.increment.gap.tail(p.nodes() / 2).setConstant(gap);
  return p;
}

}  // namespace

TEST(Undetermined, ABlockOnAFrictionlessPlaneFloatsAlongIt) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.law = Law::frictionless;
    o.shear = 0;
    const Solution s = expect_undetermined(problem_of(o), d == 2 ? 1 : 3);
    o.law = Law::coulomb;
    o.mu = 0;
    const Scene with_tangents = block(o);
    const Solution t = expect_undetermined(problem_of(o), d == 2 ? 1 : 3);
    EXPECT_LT((s.x.norm() - t.x.norm()), 1e-9 * s.x.norm());
  }
}

TEST(Undetermined, TheMethodsOnANameItTooAndReturnTheSameField) {
  for (int d : {2, 3})
    for (const Way& way : ways_on_A()) {
      SCOPED_TRACE(way.name + " " + std::to_string(d) + "D");
      BlockOptions o;
      o.d = d;
      o.cells = 3;
      o.law = Law::frictionless;
      o.shear = 0;
      const ContactProblem p = problem_of(o);
      const Solution s = expect_undetermined(p, d == 2 ? 1 : 3, way.settings, 1e-8);
      EXPECT_EQ(s.layer, way.layer);
      EXPECT_LT((s.x - solve(p, Settings()).x).norm(), 1e-6 * s.x.norm());
    }
}

TEST(Undetermined, WhatTouchesWithoutAForceHoldsNothing) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = 3;
    ContactProblem p = problem_of(o);
    p.increment.F.setZero();
    p.increment.F[p.interior()] = 1;  // passes into the obstacle at the node that it acts on
    const Solution s = solve(p, Settings());
    EXPECT_EQ(s.status, Status::converged);
    EXPECT_EQ(s.layer, Layer::newton);
    EXPECT_EQ(s.undetermined.cols(), d == 2 ? 1 : 3);
  }
}

TEST(Undetermined, AnUnloadedBodyAboveTheObstacleStaysWhereItIs) {
  std::vector<Way> ways = ways_on_A();
  ways.push_back({"auto", Settings(), Layer::newton});
  for (const Way& way : ways) {
    SCOPED_TRACE(way.name);
    const ContactProblem p = above_the_obstacle(0.01);
    const Solution s = expect_undetermined(p, 3, way.settings, 1e-8);
    EXPECT_EQ(s.layer, way.layer);
    const Vector motion = s.undetermined.rowwise().norm();
    for (Index i = 0; i < p.dofs(); ++i) EXPECT_LT(motion[i] > 0 ? std::abs(s.x[i]) : 0, 1e-12);
    for (Index i = p.nodes() / 2; i < p.nodes(); ++i) EXPECT_EQ(s.state[i], NodeState::separated);
  }
}

TEST(Undetermined, WhatBranchesBarDoesNotDependOnTheUnits) {
  for (int d : {2, 3})
    for (Real force : {1e-22, 1.0, 1e22}) {
      SCOPED_TRACE(std::to_string(d) + "D, " + std::to_string(std::log10(force)));
      BlockOptions o;
      o.d = d;
      o.E *= force;
      o.angle = 0.3;  // what bars a motion is then a sum, with its rounding
      const ContactProblem p = problem_of(o);
      const DenseMatrix W = floating_motions(*p.system);
      ASSERT_EQ(W.cols(), d == 2 ? 3 : 6);
      Branches branches(p.nodes());
      const auto set = [&](bool closed, bool stick) {
        for (Branch& b : branches) {
          b.closed = closed;
          b.stick = stick;
          b.g = 0;
        }
      };
      set(true, false);
      EXPECT_EQ(left_free(W, p, branches).cols(), d == 2 ? 1 : 3);
      set(true, true);
      EXPECT_EQ(left_free(W, p, branches).cols(), 0);
      set(false, false);
      EXPECT_EQ(left_free(W, p, branches).cols(), W.cols());
    }
}

TEST(Undetermined, WithoutALoadABodyIsAsFreeAsUnderABalancedOne) {
  const auto free_at_rest = [](ContactProblem p) {
    p.increment.F.setZero();
    const Solution s = solve(p, Settings());
    EXPECT_EQ(s.status, Status::converged);
    EXPECT_TRUE(s.x.isZero(0));
    EXPECT_LT((p.system->entries() * s.undetermined).norm(), 1e-12);
    return s.undetermined.cols();
  };
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    ContactProblem p = problem_of(o);
    EXPECT_EQ(free_at_rest(p), d == 2 ? 3 : 6);  // a touch without a force holds nothing
    p.increment.gap.setConstant(5);
    EXPECT_EQ(free_at_rest(p), d == 2 ? 3 : 6);
    p.increment.gap.setZero();
    p.increment.bilateral = true;
    EXPECT_EQ(free_at_rest(p), d == 2 ? 1 : 3);  // nothing presses, nothing rubs
    p.increment.law = Law::tresca;
    p.increment.g = Vector::Ones(p.nodes());
    EXPECT_EQ(free_at_rest(p), 0);
    o.clamp_side = true;
    EXPECT_EQ(free_at_rest(problem_of(o)), d == 2 ? 1 : 3);  // along the clamped face
  }
}

TEST(Undetermined, ABodyThatTheObstaclePushesIsNotLeftBehind) {
  const ContactProblem p = above_the_obstacle(-0.01);
  for (const Way& way : ways_on_A()) {
    SCOPED_TRACE(way.name);
    const Solution s = solve(p, way.settings);
    EXPECT_EQ(s.status, Status::converged);
    for (Index i = p.nodes() / 2; i < p.nodes(); ++i)
      EXPECT_LT(s.x[p.system->first[i]], p.increment.gap[i] + 1e-9);
  }
}

TEST(Undetermined, NoFrictionAtSomeNodesOnlyLeavesNothingFree) {
  BlockOptions o;
  o.shear = 0;
  Scene s = block(o);
  s.friction.setZero();
  s.friction[2] = 0.3;
  expect_undetermined(s.system().problem(), 0);
}

TEST(Undetermined, OrdinaryScenesHaveNone) {
  BlockOptions o;
  expect_undetermined(problem_of(o), 0);
  o.clamp_side = true;
  expect_undetermined(problem_of(o), 0);
}

TEST(Undetermined, ATouchOfLoadAlongTheFloatingMotionIsNoEquilibrium) {
  for (Law law : {Law::frictionless, Law::coulomb}) {
    BlockOptions o;
    o.law = law;
    o.mu = 0;
    o.shear = 1e-4;
    const Solution s = solve(problem_of(o), Settings());
    EXPECT_EQ(s.status, Status::no_equilibrium);
    ASSERT_EQ(s.unheld_motion.size(), s.x.size());
    EXPECT_GT(problem_of(o).increment.F.dot(s.unheld_motion), 0);
  }
}

TEST(Undetermined, TheMethodsOnAGiveTheProofThatNothingHoldsALoad) {
  for (int d : {2, 3})
    for (const Way& way : ways_on_A()) {
      SCOPED_TRACE(way.name + " " + std::to_string(d) + "D");
      BlockOptions o;
      o.d = d;
      o.cells = 2;
      o.shear = 0.4 * o.pressure;  // mu = 0.3
      const ContactProblem p = problem_of(o);
      const Solution s = solve(p, way.settings);
      EXPECT_EQ(s.status, Status::no_equilibrium);
      ASSERT_EQ(s.unheld_motion.size(), p.dofs());
      EXPECT_GT(p.increment.F.dot(s.unheld_motion), 0);
      o.shear = 0.2 * o.pressure;
      EXPECT_EQ(solve(problem_of(o), way.settings).status, Status::converged);
    }
}

TEST(Undetermined, CoupledBodiesFallOneByOne) {
  // as a mortar does: a dof of the first body is measured from one of the second, so that the graph
  // of A joins them, and so do the motions of all as one; their shears cancel, and one would do
  BlockOptions o;
  o.cells = 3;
  o.shear = 0.4 * o.pressure;  // mu = 0.3
  ContactProblem p = beside(problem_of(o), 2);
  o.shear *= -1;
  const Vector pushed_back = problem_of(o).increment.F;
  const Index n = p.dofs(), I = p.interior() / 2;
  p.increment.F.segment(I, I) = pushed_back.head(I);
  p.increment.F.tail(n / 2 - I) = pushed_back.tail(n / 2 - I);
  DenseMatrix T = DenseMatrix::Identity(n, n);
  T(0, I) = 1;
  AssembledSystem coupled = assembled(p.system);
  coupled.A = DenseMatrix(T.transpose() * DenseMatrix(coupled.A) * T).sparseView();
  coupled.D = coupled.A.diagonal();
  coupled.weight = node_weights(coupled);
  const DenseMatrix modes = T.inverse() * p.system->rigid_modes();
  coupled.rigid_modes = [modes] { return modes; };
  DenseMatrix each = DenseMatrix::Zero(n, 6);
  const DenseMatrix both = p.system->rigid_modes();
  const Bodies bodies = bodies_of(p.system->entries());
  for (Index i = 0; i < n; ++i) each.block(i, 3 * bodies.of[i], 1, 3) = both.row(i);
  coupled.body_modes = [T, each] { return Matrix((T.inverse() * each).sparseView()); };
  p.system = std::make_shared<const AssembledSystem>(coupled);
  p.increment.F = T.transpose() * p.increment.F;
  EXPECT_EQ(floating_motions(*p.system).cols(), 6);
  const Solution s = solve(p, Settings());
  EXPECT_EQ(s.status, Status::no_equilibrium);
  ASSERT_EQ(s.unheld_motion.size(), n);
  EXPECT_GT(p.increment.F.dot(s.unheld_motion), 0);
}

TEST(Undetermined, ATouchWithoutAForceHoldsNothing) {
  BlockOptions o;
  ContactProblem p = problem_of(o);
  Certificate c;
  c.r = Vector::Zero(p.dofs());
  const Vector x = Vector::Zero(p.dofs());  // on the obstacle
  const Index N = p.system->first[0];
  for (Real force : {1e-14, 1e-3}) {
    c.r[N] = force * std::sqrt(p.system->weight[N]);
    c.r[N + 1] = 0.5 * 0.3 * c.r[N];
    const auto branches = branches_of(p, x, c);
    EXPECT_EQ(branches[0].closed, force > 1e-6);
    EXPECT_EQ(branches[0].stick, force > 1e-6);
    EXPECT_FALSE(branches[1].closed);
  }
  p.increment.bilateral = true;
  EXPECT_TRUE(branches_of(p, x, c)[1].closed);
}

TEST(Undetermined, AForceThatIsNoMoreThanRoundingHoldsNothing) {
  const ContactProblem p = problem_of(BlockOptions());
  Certificate c;
  c.attainable = 1e-4;
  c.r = Vector::Zero(p.dofs());
  for (Real force : {5e-4, 5e-3}) {
    c.r[p.system->first[0]] = force * std::sqrt(p.system->weight[p.system->first[0]]);
    EXPECT_EQ(branches_of(p, Vector::Zero(p.dofs()), c)[0].closed, force > 1e-3);
  }
}

TEST(Undetermined, ANodeAtItsLimitMayGoOnSlippingAndOneBelowIsStuck) {
  const ContactProblem p = problem_of(BlockOptions());
  const Index N = p.system->first[0];
  Certificate c;
  c.r = Vector::Zero(p.dofs());
  c.r[N] = std::sqrt(p.system->weight[N]);
  const Real limit = p.increment.mu[0] * c.r[N];
  Vector x = Vector::Zero(p.dofs());
  c.r[N + 1] = -limit * (1 - 1e-4);
  EXPECT_TRUE(branches_of(p, x, c)[0].stick);
  for (Real slip : {0., -1.}) {         // at the limit it may slip
    c.r[N + 1] = -limit * (1 - 1e-14);  // rounded into the disc
    x[N + 1] = slip;
    EXPECT_FALSE(branches_of(p, x, c)[0].stick);
    EXPECT_EQ(branches_of(p, x, c)[0].d[0], -1);
  }
}

TEST(Undetermined, ShearThatIsNoMoreThanRoundingLeavesANodeStuck) {
  const ContactProblem p = problem_of(BlockOptions());
  const Index N = p.system->first[0];
  Certificate c;
  c.attainable = 1e-4;
  c.r = Vector::Zero(p.dofs());
  c.r[N] = 2e-3 * std::sqrt(p.system->weight[N]);  // its limit is below what rounding leaves
  for (Real shear : {0., 1e-4}) {
    c.r[N + 1] = shear * std::sqrt(p.system->weight[N + 1]);
    const Branch b = branches_of(p, Vector::Zero(p.dofs()), c)[0];
    EXPECT_TRUE(b.closed && b.stick);
  }
}

TEST(Undetermined, ContactLetsGoOfWhatPressedAtTheStart) {
  BlockOptions o;
  o.cells = 2;
  ContactProblem p = problem_of(o);
  const Index N = p.system->first[0];
  const Real mu = p.increment.mu[0];
  Solution s;
  const auto gone = [&](Real pressure, Real shear, Real slip) {
    s.x = Vector::Zero(p.dofs());
    s.x[N + 1] = slip;
    s.certificate = certify(p, s.x);
    s.certificate.r.setZero();
    s.certificate.r[N] = pressure;
    s.certificate.r[N + 1] = shear;
    return let_go(p, s).size();
  };
  p.increment.F.setZero();
  EXPECT_EQ(gone(0, 0, 0), 0u);
  p.increment.F[N] = -1;  // pulled at
  EXPECT_EQ(gone(0, 0, 0), 0u);
  p.increment.F[N] = 1;
  EXPECT_EQ(gone(0, 0, 0), 1u);
  EXPECT_EQ(let_go(p, s)[0].size(), std::size_t(p.nodes()));
  EXPECT_EQ(gone(0.3, 0, 0), 0u);  // it sticks
  EXPECT_EQ(gone(0.3, mu * 0.3, 1), 1u);
  EXPECT_EQ(gone(0.6, mu * 0.6, 1), 0u);
  EXPECT_EQ(gone(1e-7, 0, 0), 1u);  // by next to nothing
  p.increment.gap[0] = 1e-3;        // not pressed by anything
  EXPECT_EQ(gone(0, 0, 0), 0u);
  p.increment.gap[0] = 0;
  const Index M = p.system->first[1];
  p.increment.F[M] = 2;
  EXPECT_EQ(gone(0, 0, 0), 1u);
  s.certificate.r[M] = 0.5;  // another node sticks
  EXPECT_EQ(let_go(p, s).size(), 0u);
  s.certificate.r[M] = 2;  // or slips on under what it had
  s.certificate.r[M + 1] = 2 * mu;
  s.x[M + 1] = 1;
  EXPECT_EQ(let_go(p, s).size(), 0u);
}

TEST(Undetermined, OfSeveralBodiesThoseCountThatContactLetsGo) {
  BlockOptions o;
  o.cells = 3;
  ContactProblem p = problem_of(o);
  auto parted = std::make_shared<AssembledSystem>(assembled(p.system));
  const Index N = p.system->first[0], M = p.system->first[1];
  for (Index i = 0; i < p.dofs(); ++i)  // the first node hangs on nothing any more
    for (Matrix::InnerIterator a(parted->A, i); a; ++a)
      if ((i == N || i == N + 1) != (a.col() == N || a.col() == N + 1)) a.valueRef() = 0;
  p.system = parted;
  p.increment.F.setZero();
  p.increment.F[N] = 1;
  p.increment.F[M] = 10;
  Solution s;
  s.x = Vector::Zero(p.dofs());
  s.certificate = certify(p, s.x);
  s.certificate.r.setZero();
  s.certificate.r[M] = 10;  // sticks
  const auto gone = let_go(p, s);
  ASSERT_EQ(gone.size(), 1u);
  EXPECT_EQ(gone[0], std::vector<Index>{0});
}

TEST(Undetermined, LimitsAreOfAllThatFrictionTakes) {
  BlockOptions o;
  o.cells = 2;
  ContactProblem p = problem_of(o);
  const Index N = p.system->first[0];
  p.increment.cohesion.setConstant(p.nodes(), 3);
  p.increment.cap.setConstant(p.nodes(), 4);
  Solution s;
  s.x = Vector::Zero(p.dofs());
  s.x[N] = -1;  // open
  s.certificate = certify(p, s.x);
  s.certificate.r.setZero();
  EXPECT_EQ(limits_at(p, s)[0], 0);
  s.x[N] = 0;
  s.certificate.r[N] = 1;
  EXPECT_NEAR(limits_at(p, s)[0], 3 + o.mu, 1e-12);
  s.certificate.r[N] = 100;
  EXPECT_EQ(limits_at(p, s)[0], 4);
  // from 4 to 3.3 is no fall by half, as from 30 to 0.3 would be
  p.increment.F.setZero();
  p.increment.F[N] = 100;
  s.x[N + 1] = 1;
  s.certificate.r[N] = 1;
  s.certificate.r[N + 1] = 3.3;
  EXPECT_EQ(let_go(p, s).size(), 0u);
}

TEST(Undetermined, TwiceTheLimitsHoldMore) {
  const Vector few = Vector::Constant(4, 1);
  Vector more = few;
  more[0] = 1.5;
  EXPECT_FALSE(hold_more({{0, 1}, {2, 3}}, more, few));
  more[1] = 3;
  EXPECT_TRUE(hold_more({{0, 1}, {2, 3}}, more, few));
  EXPECT_FALSE(hold_more({{2, 3}}, more, few));
}

TEST(Undetermined, BranchesBarTheMotionsThatTheyStandAgainst) {
  BlockOptions o;
  o.d = 3;
  o.cells = 2;
  const ContactProblem p = problem_of(o);
  const DenseMatrix W = rigid_motions(p.system->entries(), p.system->D);
  std::vector<Branch> branches(p.nodes());  // all closed and stuck
  EXPECT_EQ(left_free(W, p, branches).cols(), 0);
  for (Branch& b : branches) b.stick = false;  // closed, free to slide: two slides and a turn
  EXPECT_EQ(left_free(W, p, branches).cols(), 3);
  for (Branch& b : branches) {  // all slide one way, against friction
    b.g = 1;
    b.d = {0.6, 0.8};
  }
  const DenseMatrix along = left_free(W, p, branches);
  ASSERT_EQ(along.cols(), 1);
  const Vector w = along.col(0).tail(p.contact_dofs());
  EXPECT_NEAR(std::abs(w[1] / w.segment(1, 2).norm()), 0.6, 1e-9);
  EXPECT_NEAR(w[1] * 0.8 - w[2] * 0.6, 0, 1e-9 * w.norm());
  for (Branch& b : branches) b.closed = false;
  for (Branch& b : branches) b.g = 0;
  EXPECT_EQ(left_free(W, p, branches).cols(), 6);
}

TEST(Undetermined, TheLeastIsOrthogonalAndDiffersByTheMotionsAlone) {
  const Vector D = Vector::LinSpaced(5, 1, 3);
  const DenseMatrix V = DenseMatrix::Random(5, 2);
  const auto system = std::make_shared<AssembledSystem>();
  system->first = {5};
  system->A.resize(5, 5);
  system->D = system->weight = D;
  ContactProblem problem{system, {}};
  problem.increment.F = Vector::Zero(5);
  Solution s;
  s.x = Vector::Random(5);
  s.undetermined = V;
  const Vector x = s.x;
  leave_least(problem, 1e-8, s);
  EXPECT_LT((V.transpose() * D.cwiseProduct(s.x)).norm(), 1e-13);
  const Vector c = V.colPivHouseholderQr().solve(x - s.x);
  EXPECT_LT((V * c - (x - s.x)).norm(), 1e-13);
}

/// leave_least from x, whose certificate is as good as rounding: what it makes of it obeys the laws
/// as well, and no rigid motion to another field that does leads to a lesser one.
Vector least_by_the_laws(ContactProblem p, const Vector& x) {
  const DenseMatrix W = p.system->rigid_modes();
  const auto size = [&](const Vector& v) { return v.dot(p.system->D.cwiseProduct(v)); };
  Solution s;
  s.x = x;
  s.certificate = certify(p, x);
  s.undetermined = W;
  EXPECT_LT(s.certificate.residual, 1e-8);
  leave_least(p, 1e-8, s);
  EXPECT_LT(s.certificate.residual, 1e-8);
  const auto allowed = [&](const Vector& v) { return certify(p, v).residual <= 1e-8; };
  int compared = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vector c = Vector::Random(W.cols()) * std::pow(10, -4.0 * k / 3000);
    const Vector other = s.x + W * c / W.cwiseAbs().maxCoeff();
    if (!allowed(other)) continue;
    ++compared;
    EXPECT_GE(size(other), (1 - 1e-7) * size(s.x));
  }
  EXPECT_GT(compared, 50);
  EXPECT_LT(size(s.x), 0.9 * size(x));
  return s.x;
}

TEST(Undetermined, TheLeastClosesNoGapBeyondContact) {
  BlockOptions o;
  o.cells = 3;
  o.law = Law::frictionless;
  ContactProblem p = problem_of(o);
  const DenseMatrix W = p.system->rigid_modes();
  p.increment.F.setZero();
  p.increment.gap = Vector::LinSpaced(p.nodes(), -1, -0.6);  // it has to go, by a turn and a way
  p.increment.load_norm = 0;
  // a translation away from the obstacle, and another one with a turn
  const Vector away = least_squares(W.bottomRows(p.contact_dofs()), Vector::Ones(p.contact_dofs())),
               turned = away + Vector(0.2 * Vector::Ones(W.cols()));
  const Vector x = least_by_the_laws(p, -2 * W * away), y = least_by_the_laws(p, -9 * W * turned);
  EXPECT_LT((x - y).norm(), 1e-9 * x.norm());
}

TEST(Undetermined, TheLeastMayRoundWhereTheFieldDoes) {
  BlockOptions o;
  o.law = Law::frictionless;
  o.shear = 0;
  const ContactProblem p = problem_of(o);
  Solution s = solve(p, Settings());
  ASSERT_EQ(s.undetermined.cols(), 1);
  const Vector least = s.x, x = least + 0.1 * least.norm() * s.undetermined;
  const auto from = [&](Real residual, Real tol) {
    s.x = x;
    s.certificate.residual = residual;  // below what rounding leaves of any field
    leave_least(p, tol, s);
    return Real((s.x - least).norm());
  };
  EXPECT_LT(from(1e-30, 1e-31), 1e-9 * least.norm());
  EXPECT_EQ(from(1e-30, 1e-30), (x - least).norm());  // within tol it stays
}

TEST(Undetermined, TheLeastTurnsNoSlipBack) {
  BlockOptions o;
  o.cells = 3;
  o.law = Law::tresca;
  ContactProblem p = problem_of(o);
  const DenseMatrix W = p.system->rigid_modes();
  p.increment.gap.setConstant(100);  // open, where a given limit acts as well
  // r_T = g d at the slip of some field in which all nodes slip one way
  Vector x = Vector::Zero(p.dofs()), r = x;
  for (Index i = 0; i < p.dofs(); ++i) x[i] = 0.01 * std::sin(7.0 * i);
  for (Index i = 0; i < p.nodes(); ++i) r[p.system->first[i] + 1] = p.increment.g[i];
  Vector ones = Vector::Zero(p.contact_dofs());
  for (Index i = 0; i < p.nodes(); ++i) ones[p.system->first[i] + 1 - p.interior()] = 1;
  const Vector slide = W * least_squares(W.bottomRows(p.contact_dofs()), ones);
  p.increment.F = p.system->entries() * x + r;
  const Vector a = least_by_the_laws(p, x + slide), b = least_by_the_laws(p, x + 5 * slide);
  EXPECT_LT((a - b).norm(), 1e-9 * a.norm());
}

TEST(Undetermined, ASupportOfATrillionthDeterminesAMotionThatSTakesForRigid) {
  for (bool known : {true, false})
    for (Real support : {0.0, 1.2e-12}) {  // over the diagonal of A, at every dof
      BlockOptions o;
      o.cells = 2;
      o.shear = 0;
      ContactProblem p = problem_of(o);
      const auto system = std::make_shared<AssembledSystem>(assembled(p.system));
      for (Index i = 0; i < system->dofs(); ++i) system->A.coeffRef(i, i) += support * system->D[i];
      if (!known) system->rigid_modes = {};
      p.increment.mu.setZero();  // but with tangents
      p.system = system;
      expect_undetermined(p, support > 0 ? 0 : 1, Settings(), 1e-8);
    }
}
