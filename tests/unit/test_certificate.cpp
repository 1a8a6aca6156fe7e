#include <gtest/gtest.h>

#include "core/solver.h"
#include "verifier.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

Scene solved_scene(Vector& x) {
  BlockOptions o;
  o.cells = 6;
  o.shear = 2.5;
  const Scene s = block(o);
  Settings settings;
  const Solution solution = solve(s.system().problem(), settings);
  EXPECT_EQ(solution.status, Status::converged);
  x = solution.x;
  return s;
}

}  // namespace

TEST(Certificate, IsTheScaledNormOfTheThreeLawsInDenseArithmetic) {
  Vector x;
  const Scene s = solved_scene(x);
  const Posed system = s.system();
  const ContactProblem& p = system.problem();
  x += 1e-4 * Vector::Random(x.size());
  const Eigen::MatrixXd A = p.system->A;
  const Vector r = p.increment.F - A * x;
  Real sum = 0, load = 0;
  for (Index i = 0; i < p.dofs(); ++i) load += p.increment.F[i] * p.increment.F[i] / A(i, i);
  for (Index i = 0; i < p.system->first[0]; ++i) sum += r[i] * r[i] / A(i, i);
  for (Index k = 0; k < p.nodes(); ++k) {
    const Index N = p.system->first[k], T = N + 1;
    sum += std::pow(std::min(A(N, N) * (p.increment.gap[k] - x[N]), r[N]), 2) / A(N, N);
    const Real g = p.increment.mu[k] * std::max(r[N], 0.0);
    const Real y = r[T] + A(T, T) * x[T];
    sum += std::pow(r[T] - std::max(-g, std::min(g, y)), 2) / A(T, T);
  }
  EXPECT_NEAR(certify(p, x).residual, std::sqrt(sum / load), 1e-12);
}

TEST(Certificate, IsInvariantUnderAChangeOfUnits) {
  Vector x;
  Scene s = solved_scene(x);
  x += 1e-4 * Vector::Random(x.size());
  const Real before = certify(s.system().problem(), x).residual;
  for (Real& a : s.a) a *= 1e6 / 1e-3;  // forces by 1e6, lengths by 1e-3
  s.b *= 1e6;
  s.gap *= 1e-3;
  EXPECT_NEAR(certify(s.system().problem(), 1e-3 * x).residual, before, 1e-12 * before);
}

TEST(Certificate, SeesEachLawBroken) {
  Vector x;
  const Scene s = solved_scene(x);
  const Posed system = s.system();
  const ContactProblem& p = system.problem();
  EXPECT_LT(certify(p, x).residual, 1e-8);
  Vector y = x;
  y[0] += 1e-3;
  EXPECT_GT(certify(p, y).equilibrium, 1e-3);
  y = x;
  y[p.system->first[3]] += 1e-3;  // penetration
  EXPECT_GT(certify(p, y).normal, 1e-3);
  y = x;
  y[p.system->first[3] + 1] += 1e-3;  // sliding without its force
  EXPECT_GT(certify(p, y).friction, 1e-3);
}

TEST(Certificate, WithoutALoadNothingIsDividedByZero) {
  BlockOptions o;
  o.pressure = o.shear = 0;
  const Scene s = block(o);
  const Posed system = s.system();
  EXPECT_EQ(certify(system.problem(), Vector::Zero(system.problem().dofs())).residual, 0);
  const Solution solution = solve(system.problem(), Settings());
  EXPECT_EQ(solution.status, Status::converged);
}

TEST(Certificate, ClassifiesOpenSlipAndStick) {
  Vector x;
  const Scene s = solved_scene(x);
  const Posed system = s.system();
  const Certificate c = certify(system.problem(), x);
  const auto state = classify(system.problem(), x, c);
  const Vector force = system.force_to_global(c.r);
  int count[4] = {0, 0, 0, 0};
  for (Index k = 0; k < system.nodes(); ++k) {
    ++count[int(state[k])];
    const Index N = system.problem().system->first[k];
    if (state[k] == NodeState::separated) {
      EXPECT_NEAR(c.r[N], 0, 1e-6);
    } else {
      EXPECT_NEAR(x[N], 0, 1e-9);
      EXPECT_GT(c.r[N], 0);
    }
    if (state[k] == NodeState::stick) {
      EXPECT_NEAR(x[N + 1], 0, 1e-9);
    }
    if (state[k] == NodeState::slip) {
      EXPECT_NEAR(std::abs(c.r[N + 1]), 0.3 * c.r[N], 1e-6);
    }
  }
  EXPECT_GT(count[int(NodeState::slip)], 0);
  EXPECT_GT(count[int(NodeState::stick)] + count[int(NodeState::separated)], 0);
}
