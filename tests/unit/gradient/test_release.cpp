// When held nodes are let go, and what follows: what tells GC1, GC2, GC3 and GCX apart.
#include <gtest/gtest.h>

#include "core/gradient/release_rule.h"
#include "recorder.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// A block that was pressed flat and is bent up: many nodes let go, and few at once.
struct Peeled {
  ContactProblem p;
  Vector x0;
  Real scale;
  explicit Peeled(int d, Real limit = 0.3) {
    BlockOptions o;
    o.d = d;
    o.cells = d == 2 ? 16 : 4;
    o.clamp_side = true;
    o.law = Law::tresca;
    o.mu = limit / (d == 2 ? 1 : 8);
    o.pressure = 1;
    o.shear = 8;
    p = block(o).system().problem();
    x0 = Vector::Zero(p.dofs());
    scale = norm_D(*p.system, p.increment.F);
  }
  Minimized by(Method method, Real tol = 1e-8, Real eps = 1e-8,
               Regularization reg = Regularization::polynomial) const {
    Settings settings{method};
    settings.reg = reg;
    return minimize(p, settings, p.increment.g, x0, eps, tol * scale);
  }
};

/// How often an iteration that let nodes go is followed by one along a conjugate direction.
Index conjugate_after_release(const Minimized& m) {
  Index count = 0;
  for (std::size_t k = 1; k < m.steps.size(); ++k)
    count += m.steps[k - 1].label == StepLabel::release && m.steps[k].label == StepLabel::conjugate;
  return count;
}

}  // namespace

TEST(Release, Gc1RestartsAfterwardsAndGc2KeepsConjugating) {
  for (int d : {2, 3}) {
    // smooth, so that nothing but the release restarts
    const Regularization smooth = Regularization::square_root;
    const Minimized a = Peeled(d).by(Method::gc1, 1e-8, 1e-4, smooth);
    const Minimized b = Peeled(d).by(Method::gc2, 1e-8, 1e-4, smooth);
    EXPECT_GT(a.outcome.steps[StepLabel::release], 0);
    EXPECT_GT(b.outcome.steps[StepLabel::release], 0);
    EXPECT_EQ(conjugate_after_release(a), 0);
    EXPECT_GT(conjugate_after_release(b), 0) << d;
  }
}

TEST(Release, Gc3WaitsForPartialConvergenceAndRestarts) {
  for (int d : {2, 3}) {
    const Peeled c(d);
    const Real tol = 1e-6;
    const Minimized a = c.by(Method::gc3, tol), at_once = c.by(Method::gc1, tol);
    Index released = 0;
    for (const Recorded& step : a.steps) {
      if (step.label != StepLabel::release) continue;
      ++released;
      if (step.x == a.steps.front().x) continue;  // let go before the first step
      EXPECT_LE(open_residual(c.p, c.p.increment.g, a.phi, step.x), 1.01 * 100 * tol * c.scale);
    }
    EXPECT_GT(released, 0);
    EXPECT_LT(released, at_once.outcome.steps[StepLabel::release]);
    EXPECT_EQ(conjugate_after_release(a), 0);
  }
}

TEST(Release, GcxLetsGoWhereTheFaceHasLessToGiveThanItsReleaseAndLowersJ) {
  for (int d : {2, 3}) {
    const Minimized a = Peeled(d).by(Method::gcx);
    EXPECT_EQ(a.outcome.status, Status::converged);
    EXPECT_GT(a.outcome.steps[StepLabel::release], 0);
    EXPECT_EQ(conjugate_after_release(a), 0);
    const Minimized b = Peeled(d).by(Method::gc3);
    EXPECT_LE(a.outcome.iterations(), 3 * b.outcome.iterations());
  }
}

TEST(Release, AStepAcrossEpsIsFollowedByARestartWhereTheStepIsExact) {
  for (int d : {2, 3}) {
    const Peeled c(d);
    const Minimized a = c.by(Method::gc3);
    Index crossings = 0;
    for (std::size_t k = 1; k + 1 < a.steps.size(); ++k) {
      bool crossed = false;
      for (Index i = 0; i < c.p.nodes(); ++i)
        crossed |= (tangential_norm(*c.p.system, i, a.steps[k].x) <= a.phi.eps) !=
                   (tangential_norm(*c.p.system, i, a.steps[k - 1].x) <= a.phi.eps);
      if (!crossed) continue;
      ++crossings;
      EXPECT_NE(a.steps[k + 1].label, StepLabel::conjugate);
    }
    EXPECT_GT(crossings, 0);
  }
}

TEST(Release, LabelsNameGapsThatCloseAndNodesThatComeToRest) {
  BlockOptions o;
  o.cells = 12;
  o.clamp_side = true;
  o.law = Law::tresca;
  o.mu = 0.4;
  o.shear = -4;
  Scene s = block(o);
  for (Index k = 0; k < s.gap.size(); ++k) s.gap[k] = 2e-4 * k * k / 12;
  const ContactProblem p = s.system().problem();
  Settings settings{Method::gcx};
  std::srand(3);
  const Vector x0 = 0.01 * Vector::Random(p.dofs());  // slides everywhere
  const Minimized a = minimize(p, settings, p.increment.g, x0, 0, 1e-9);
  EXPECT_EQ(a.outcome.status, Status::converged);
  EXPECT_GT(a.outcome.steps[StepLabel::contact_hit] + a.outcome.steps[StepLabel::expansion], 0);
  EXPECT_GT(a.outcome.steps[StepLabel::stick_frozen], 0);
  for (std::size_t k = 1; k < a.steps.size(); ++k) {
    Index more_contact = 0, more_rest = 0;
    for (Index i = 0; i < p.nodes(); ++i) {
      const Index N = p.system->first[i];
      const auto touches = [&](const Vector& x) { return x[N] == p.increment.gap[i]; };
      const auto rests = [&](const Vector& x) { return p.tangents(i) == 0 || x[N + 1] == 0; };
      more_contact += touches(a.steps[k].x) && !touches(a.steps[k - 1].x);
      more_rest += rests(a.steps[k].x) && !rests(a.steps[k - 1].x);
    }
    const StepLabel label = a.steps[k].label;
    if (label == StepLabel::contact_hit || label == StepLabel::expansion) {
      EXPECT_GT(more_contact, 0);
    }
    if (label == StepLabel::conjugate || label == StepLabel::restart) {
      EXPECT_EQ(more_contact + more_rest, 0);
    }
  }
  settings.method = Method::gc1;  // stops at the first gap
  const Minimized b = minimize(p, settings, p.increment.g, x0, 1e-6, 1e-9);
  EXPECT_GT(b.outcome.steps[StepLabel::contact_hit], 0);
}

TEST(Release, GcxGoesOnBeyondTheFirstGapAndClosesManyInOneIteration) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = d == 2 ? 20 : 5;
    o.clamp_side = true;
    o.law = Law::tresca;
    o.mu = 0.1;
    Scene s = block(o);
    for (Index k = 0; k < s.gap.size(); ++k) s.gap[k] = 1e-4 * k / Real(s.gap.size());
    const ContactProblem p = s.system().problem();
    Settings settings{Method::gcx};
    const Vector x0 = Vector::Zero(p.dofs());
    const Minimized a = minimize(p, settings, p.increment.g, x0, 0, 1e-9);
    EXPECT_EQ(a.outcome.status, Status::converged);
    EXPECT_GT(a.outcome.steps[StepLabel::expansion], 0) << d;
    Index most = 0;
    for (std::size_t k = 1; k < a.steps.size(); ++k) {
      Index closed = 0;
      for (Index i = 0; i < p.nodes(); ++i)
        closed += a.steps[k].x[p.system->first[i]] == p.increment.gap[i] &&
                  a.steps[k - 1].x[p.system->first[i]] < p.increment.gap[i];
      most = std::max(most, closed);
    }
    EXPECT_GE(most, 3) << d;
  }
}

TEST(Release, GcxStepsAlongWhatTheFacesViolateToTheMinimumOfJ) {
  for (int d : {2, 3}) {
    Peeled c(d);
    // held everywhere: some nodes pull, some are pushed beyond their limit
    Iterate it(c.p);
    it.x = c.x0;
    it.g = c.p.increment.g;
    it.faces.start(it.x, it.g, Tangents::sliding, true);
    const Vector r = c.p.increment.F - c.p.system->entries() * it.x;
    std::srand(2);
    const Vector pull = r + c.scale * Vector::Random(r.size());
    it.rows.start(pull);
    Vector beta = Vector::Zero(r.size());
    for (Index i = 0; i < c.p.nodes(); ++i) {
      const Index N = c.p.system->first[i], t = c.p.tangents(i);
      beta[N] = std::min(pull[N], 0.0);
      const Vector r_T = pull.segment(N + 1, t);
      if (r_T.norm() > it.g[i]) beta.segment(N + 1, t) = (1 - it.g[i] / r_T.norm()) * r_T;
    }
    EXPECT_NEAR(it.faces.violation(it.rows.r(), it.g), norm_D(*c.p.system, beta), 1e-12);
    const Vector direction = beta.cwiseQuotient(c.p.system->weight);
    const Real rho = beta.dot(direction) / direction.dot(c.p.system->entries() * direction);
    Settings settings{Method::gcx};
    ReleaseRule rule(settings, *c.p.system);
    EXPECT_EQ(rule.threshold(1e-9, 0.7), 0.7);
    ASSERT_TRUE(rule.release(it, 0));
    EXPECT_LT((it.x - c.x0 - rho * direction).norm(), 1e-12 * (rho * direction).norm());
    const Vector left = pull - c.p.system->entries() * (rho * direction);
    EXPECT_LT((it.rows.r() - left.tail(c.p.contact_dofs())).norm(), 1e-10 * left.norm());
    for (Index i = 0; i < c.p.nodes(); ++i) {
      const Index N = c.p.system->first[i], t = c.p.tangents(i);
      EXPECT_EQ(it.faces.contact(i), beta[N] == 0);
      EXPECT_EQ(it.faces.at_rest(i), t > 0 && it.g[i] > 0 && beta.segment(N + 1, t).isZero(0));
    }
    EXPECT_FALSE(rule.release(it, 1e6 * c.scale));  // what the tolerance covers stays
  }
}
