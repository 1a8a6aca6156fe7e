// One minimization at a given sliding limit, each method alone: no fixed point, no other layer
// behind it.
#include <gtest/gtest.h>

#include "../condensed/by_hand.h"
#include "recorder.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

constexpr Method all[] = {Method::gc1, Method::gc2, Method::gc3, Method::gcx, Method::sorp};
constexpr Method conjugate[] = {Method::gc1, Method::gc2, Method::gc3, Method::gcx};

/// A clamped block at given limits, some of them 0, and its exact answer. With `gaps` it opens and
/// closes on the way.
struct Given {
  ContactProblem p;
  Vector g, exact;
  Real scale = 1, length = 1;
  Given(int d, bool bilateral, unsigned seed, bool gaps = true, Real pressure = 10) {
    BlockOptions o;
    o.d = d;
    o.cells = d == 2 ? 8 : 3;
    o.clamp_side = true;
    o.law = Law::tresca;
    o.shear = d == 2 ? 6 : 8;
    o.pressure = pressure;
    o.distortion = 0.2;
    o.seed = seed;
    Scene s = block(o);
    std::mt19937 random(seed);
    std::uniform_real_distribution<Real> uniform(0, 1);
    for (Index k = 0; k < s.gap.size(); ++k) {
      s.friction[k] = uniform(random) < 0.2 ? 0 : 2.0 / (d == 2 ? 1 : 3) * uniform(random);
      if (gaps && !bilateral) s.gap[k] = 0.002 * (uniform(random) - 0.3);
    }
    p = s.system().problem();
    p.increment.bilateral = bilateral;
    g = p.increment.g;
    Settings settings;
    settings.tol = 1e-12;
    const Solution a = solve(p, settings);
    EXPECT_EQ(a.status, Status::converged);
    exact = a.x;
    scale = a.certificate.scale;
    length = exact.lpNorm<Eigen::Infinity>();
  }
  Real eps() const { return 1e-8 * length; }
  Minimized by(Method method, const Vector& x0, Real tol = 1e-10) const {
    Settings settings{method};
    return minimize(p, settings, g, x0, eps(), tol * scale);
  }
};

Real accuracy(Method m) { return m == Method::gcx || m == Method::sorp ? 1e-7 : 1e-5; }

Real penetration(const ContactProblem& p, const Vector& x) {
  Real most = -1e300;
  for (Index i = 0; i < p.nodes(); ++i)
    most = std::max(most, x[p.system->first[i]] - p.increment.gap[i]);
  return most;
}

void expect_descent(const Given& c, const Minimized& m, const char* what) {
  Real before = INFINITY;
  for (const Recorded& step : m.steps) {
    const Real J = energy(c.p, c.g, m.phi, step.x);
    EXPECT_LE(J, before + 1e-13 * std::abs(J)) << what;
    before = J;
    EXPECT_LE(penetration(c.p, step.x), 0) << what;
  }
}

}  // namespace

TEST(Minimize, ReachesTheExactAnswerFromRestWhileJNeverRisesAndNothingPenetrates) {
  for (Method m : all)
    for (int d : {2, 3})
      for (bool bilateral : {false, true})
        for (unsigned seed : {1, 2, 3}) {
          std::ostringstream what;
          what << "method " << int(m) << " d " << d << " bilateral " << bilateral << " seed "
               << seed;
          const Given c(d, bilateral, seed);
          const Minimized a = c.by(m, Vector::Zero(c.p.dofs()));
          EXPECT_EQ(a.outcome.status, Status::converged) << what.str();
          EXPECT_LT((a.x - c.exact).norm(), accuracy(m) * c.exact.norm()) << what.str();
          EXPECT_EQ(a.outcome.iterations(), Index(a.steps.size())) << what.str();
          expect_descent(c, a, what.str().c_str());
        }
}

TEST(Minimize, ReachesTheExactAnswerFromAFieldThatPenetratesAndSlides) {
  for (Method m : all)
    for (int d : {2, 3})
      for (unsigned seed : {4, 5}) {
        const Given c(d, false, seed);
        std::srand(seed);
        const Vector x0 = c.length * Vector::Random(c.p.dofs());
        const Minimized a = c.by(m, x0);
        EXPECT_EQ(a.outcome.status, Status::converged) << int(m) << d << seed;
        EXPECT_LT((a.x - c.exact).norm(), accuracy(m) * c.exact.norm()) << int(m) << d << seed;
        expect_descent(c, a, "from afar");
      }
}

TEST(Minimize, StartedFromTheExactAnswerItStaysThere) {
  for (Method m : {Method::gcx, Method::sorp})
    for (int d : {2, 3}) {
      const Given c(d, false, 1);
      Vector x = c.exact;  // on its faces to the last digit
      for (Index i = 0; i < c.p.nodes(); ++i) {
        const Index N = c.p.system->first[i], t = c.p.tangents(i);
        if (std::abs(x[N] - c.p.increment.gap[i]) < 1e-14) x[N] = c.p.increment.gap[i];
        if (x.segment(N + 1, t).norm() < 1e-14) x.segment(N + 1, t).setZero();
      }
      EXPECT_LE(c.by(m, x, 1e-8).outcome.iterations(), 1) << int(m) << d;
    }
}

TEST(Minimize, AReleaseThatMeetsTheAnswerExactlyIsConverged) {
  // one node on two springs: what tension leaves of the residual is 0 to the last digit
  const ContactProblem p = ByHand(2, diag({2, 1}), vec({-1, 0.5})).given(1).problem;
  Settings settings{Method::gcx};
  for (Tangents tangents : {Tangents::stuck, Tangents::sliding}) {
    const Minimized a = minimize(p, settings, p.increment.g, Vector::Zero(2), 0, 1e-10, tangents);
    EXPECT_EQ(a.outcome.status, Status::converged);
    EXPECT_EQ(a.x, vec({-0.5, 0}));
  }
}

TEST(Minimize, ConvergedMeansThatTheBoundOnTheResidualHolds) {
  for (Method m : conjugate)
    for (int d : {2, 3})
      for (Real tol : {1e-3, 1e-6, 1e-9}) {
        const Given c(d, false, 6);
        const Minimized a = c.by(m, Vector::Zero(c.p.dofs()), tol);
        ASSERT_EQ(a.outcome.status, Status::converged);
        EXPECT_LE(open_residual(c.p, c.g, a.phi, a.x), 1.01 * tol * c.scale + 1e-13 * c.scale);
        // a node in contact pulls by no more than the bound either
        const Vector r = c.p.increment.F - c.p.system->entries() * a.x;
        for (Index i = 0; i < c.p.nodes(); ++i) {
          const Index N = c.p.system->first[i];
          if (a.x[N] != c.p.increment.gap[i]) continue;
          EXPECT_GE(r[N], -1.01 * tol * c.scale * std::sqrt(c.p.system->weight[N]));
        }
      }
}

TEST(Minimize, AsInThePapersTablesItStopsWhereAStepIsSmallBesideX) {
  const Given c(2, false, 6);
  Settings settings{Method::gc3};
  settings.stop_on_step = 1e-3;
  const Minimized a = minimize(c.p, settings, c.g, Vector::Zero(c.p.dofs()), c.eps(), 0);
  EXPECT_EQ(a.outcome.status, Status::converged);
  for (std::size_t k = 1; k < a.steps.size(); ++k) {
    const Vector &x = a.steps[k].x, dx = x - a.steps[k - 1].x;
    const bool is_last = k + 1 == a.steps.size(), released = a.steps[k].label == StepLabel::release;
    EXPECT_EQ(dx.norm() <= 1e-3 * x.norm(), is_last || released) << k;
  }
}

TEST(Minimize, TensionOnAFaceThatIsOtherwiseSolvedIsNotConverged) {
  // held everywhere, the bilateral answer has tensile nodes and no residual on its free dofs
  for (Method m : conjugate)
    for (int d : {2, 3}) {
      const Given held(d, true, 7, false, 1), open(d, false, 7, false, 1);
      const Minimized a = open.by(m, held.exact);
      EXPECT_EQ(a.outcome.status, Status::converged) << int(m) << d;
      EXPECT_GT((held.exact - open.exact).norm(), 1e-3 * open.exact.norm());
      EXPECT_LT((a.x - open.exact).norm(), accuracy(m) * open.exact.norm()) << int(m) << d;
    }
}

TEST(Minimize, StuckTangentsStayAtRest) {
  for (Method m : all)
    for (int d : {2, 3}) {
      const Given c(d, false, 8);
      Settings settings{m};
      const Minimized a = minimize(c.p, settings, c.g, c.exact, 1, 1e-9 * c.scale, Tangents::stuck);
      EXPECT_EQ(a.outcome.status, Status::converged);
      Vector r = c.p.increment.F - c.p.system->entries() * a.x;
      for (Index i = 0; i < c.p.nodes(); ++i) {
        EXPECT_EQ(tangential_norm(*c.p.system, i, a.x), 0);
        r.segment(c.p.system->first[i] + 1, c.p.tangents(i)).setZero();
        if (a.x[c.p.system->first[i]] == c.p.increment.gap[i]) r[c.p.system->first[i]] = 0;
      }
      EXPECT_LE(norm_D(*c.p.system, r), 1.01e-9 * c.scale);
    }
}

TEST(Minimize, EveryPreconditionerRegularizationAndStepGivesTheSameAnswer) {
  for (int d : {2, 3})
    for (Precon precon : {Precon::none, Precon::diagonal, Precon::ssor, Precon::hessian_diagonal,
                          Precon::hessian_ssor})
      for (Regularization reg :
           {Regularization::polynomial, Regularization::square_root, Regularization::log_cosh})
        for (Step step : {Step::exact, Step::newton, Step::false_position}) {
          const Given c(d, false, 9);
          Settings settings{Method::gc3};
          settings.precon = precon;
          settings.reg = reg;
          settings.step = step;
          const Real eps = 0.05 * c.length;  // where each of them converges
          const Vector x0 = Vector::Zero(c.p.dofs());
          const Minimized a = minimize(c.p, settings, c.g, x0, eps, 1e-9 * c.scale);
          settings = Settings();
          settings.method = Method::gc3;
          settings.reg = reg;
          const Minimized b = minimize(c.p, settings, c.g, x0, eps, 1e-11 * c.scale);
          EXPECT_EQ(a.outcome.status, Status::converged)
              << d << int(precon) << int(reg) << int(step);
          EXPECT_LT((a.x - b.x).norm(), 1e-6 * b.x.norm()) << d << int(precon) << int(step);
          if (precon == Precon::hessian_ssor) expect_descent(c, a, "regularized");
        }
}

TEST(Minimize, StickAsAFaceTakesEveryPreconditioner) {
  for (int d : {2, 3})
    for (Precon precon : {Precon::none, Precon::diagonal, Precon::ssor, Precon::hessian_diagonal,
                          Precon::hessian_ssor}) {
      const Given c(d, false, 10);
      Settings settings{Method::gcx};
      settings.precon = precon;
      const Minimized a =
          minimize(c.p, settings, c.g, Vector::Zero(c.p.dofs()), 0, 1e-10 * c.scale);
      EXPECT_EQ(a.outcome.status, Status::converged) << d << int(precon);
      EXPECT_LT((a.x - c.exact).norm(), 1e-7 * c.exact.norm()) << d << int(precon);
      expect_descent(c, a, "GCX");
    }
}

TEST(Minimize, TheBoundOnIterationsIsSharedByAllMinimizationsOfASolver) {
  for (Method m : all) {
    const Given c(2, false, 1);
    Settings settings{m};
    settings.nbiter = 5;
    const auto solver = make_tresca_solver(c.p, settings, nullptr);
    Vector x = Vector::Zero(c.p.dofs());
    const Outcome a = solver->minimize(x, c.g, c.eps(), Tangents::sliding, 1e-12 * c.scale);
    EXPECT_EQ(a.status, Status::max_iterations);
    EXPECT_EQ(a.iterations(), 5);
    const Outcome b = solver->minimize(x, c.g, c.eps(), Tangents::sliding, 1e-12 * c.scale);
    EXPECT_EQ(b.status, Status::max_iterations);
    EXPECT_EQ(b.iterations(), 0);
  }
}

TEST(Minimize, AnIndefiniteMatrixIsNamedAndALoadThatNothingHoldsProvesNothing) {
  for (Method m : conjugate) {
    const Given c(2, false, 1);
    auto indefinite = std::make_shared<AssembledSystem>(assembled(c.p.system));
    indefinite->A *= 1.5;
    for (Index i = 0; i < c.p.dofs(); ++i) indefinite->A.coeffRef(i, i) = indefinite->D[i];
    const ContactProblem p{indefinite, c.p.increment};
    Settings settings{m};
    const Vector x0 = Vector::Zero(p.dofs());
    EXPECT_EQ(minimize(p, settings, c.g, x0, c.eps(), 1e-9 * c.scale).outcome.status,
              Status::not_positive_definite);

    if (m == Method::gc1 || m == Method::gc2) continue;  // do not get there in 20000 iterations
    BlockOptions o;
    o.law = Law::tresca;
    o.mu = 0.3;
    o.shear = 2;  // five nodes hold 1.5
    const ContactProblem free = block(o).system().problem();
    EXPECT_EQ(minimize(free, settings, free.increment.g, Vector::Zero(free.dofs()), 1e-10, 1e-9)
                  .outcome.status,
              Status::stagnated);
  }
}

TEST(Minimize, SweepsThatLeaveTheRangeOfNumbersEndNamed) {
  const Given c(2, false, 1);
  Settings settings{Method::sorp};
  settings.omega = 2.5;
  const Vector x0 = Vector::Zero(c.p.dofs());
  EXPECT_EQ(minimize(c.p, settings, c.g, x0, 0, 1e-9 * c.scale).outcome.status, Status::stagnated);
}
