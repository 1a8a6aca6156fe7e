// The fixed point alone: minimizations are played by a map g -> mu r_N that the test chooses.
#include <gtest/gtest.h>

#include <functional>

#include "../condensed/by_hand.h"
#include "../scene.h"
#include "core/gradient/fixed_point.h"
#include "core/solver.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// m nodes in 2D, none coupled to another: A_i = [[2, 1], [1, 2]], gap 0, mu = 1. With x_N = 0,
/// r_N = F_N - x_T takes any value; the laws hold at slip, x_T = 1 and r_T = r_N = g*.
ContactProblem nodes_apart(const Vector& g_star) {
  const Index m = static_cast<Index>(g_star.size());
  DenseMatrix A = DenseMatrix::Zero(2 * m, 2 * m);
  Vector F(2 * m);
  for (Index i = 0; i < m; ++i) {
    A.block<2, 2>(2 * i, 2 * i) << 2, 1, 1, 2;
    F.segment<2>(2 * i) << g_star[i] + 1, g_star[i] + 2;  // r_N = r_T = g* at x_T = 1
  }
  return ByHand(2, A, F).mu(1).problem;
}

/// "Minimizes" by moving x_T so that r_N = G(g).
class Played final : public TrescaSolver {
 public:
  Played(const ContactProblem& p, std::function<Vector(const Vector&)> G)
      : problem_(p), G_(std::move(G)) {}
  Outcome minimize(Vector& x, const Vector& g, Real, Tangents tangents, Real bound) override {
    Outcome o;
    o.steps.add(StepLabel::conjugate);
    if (tangents == Tangents::stuck) {
      x.setZero();
      return o;
    }
    asked.push_back(g);
    bounds.push_back(bound);
    images.push_back(G_(g));
    for (Index i = 0; i < problem_.nodes(); ++i) {
      x[2 * i] = 0;
      x[2 * i + 1] = problem_.increment.F[2 * i] - images.back()[i];
    }
    return o;
  }
  bool regularized() const override { return false; }
  std::vector<Vector> asked, images;
  std::vector<Real> bounds;

 private:
  const ContactProblem& problem_;
  std::function<Vector(const Vector&)> G_;
};

Settings coulomb() {
  Settings s{Method::gcx};
  s.tol = 1e-9;
  return s;
}

bool damped(const Played& played, std::size_t k) {
  const Vector half = 0.5 * (played.asked[k] + played.images[k]);
  return (played.asked[k + 1] - half).norm() <= 1e-12 * half.norm();
}

}  // namespace

TEST(FixedPoint, AccelerationFindsTheLimitsOfALinearMapInAFewPasses) {
  const Vector g_star = vec({2, 3, 5});
  const ContactProblem p = nodes_apart(g_star);
  Eigen::Matrix3d M;
  M << -0.95, 0.3, 0, 0, -0.9, 0.2, 0, 0, -0.85;  // 0.95^k takes 400 passes
  Played played(p, [&](const Vector& g) { return Vector(g_star + M * (g - g_star)); });
  const Settings settings = coulomb();
  const Solution a = fixed_point(p, settings, played, {});
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_LE(a.passes, 12);
  EXPECT_LT((played.asked.back() - g_star).norm(), 1e-8);
  EXPECT_EQ(a.iterations, a.passes + 1);
  EXPECT_EQ(a.steps[StepLabel::conjugate], a.iterations);
}

TEST(FixedPoint, DampingEngagesWhereAccelerationDoesNotHelp) {
  const Vector g_star = vec({2, 3});
  const ContactProblem p = nodes_apart(g_star);
  std::srand(3);
  int calls = 0;  // noise at first, then a map that cycles undamped: slope -1
  Played played(p, [&](const Vector& g) -> Vector {
    if (++calls <= 18) return g_star + Vector(0.5 * Vector::Random(2));
    return g_star - (g - g_star);
  });
  const Settings settings = coulomb();
  const Solution a = fixed_point(p, settings, played, {});
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_GT(a.passes, 16);
  EXPECT_LE(a.passes, 22);
  EXPECT_TRUE(damped(played, played.asked.size() - 2));
  EXPECT_FALSE(damped(played, 3));
}

TEST(FixedPoint, WithoutProgressItEndsNamed) {
  const Vector g_star = vec({2, 3});
  const ContactProblem p = nodes_apart(g_star);
  std::srand(4);
  Played played(p, [&](const Vector&) { return Vector(g_star + Vector(0.5 * Vector::Random(2))); });
  const Settings settings = coulomb();
  const Solution a = fixed_point(p, settings, played, {});
  EXPECT_EQ(a.status, Status::fixed_point_diverged);
  EXPECT_LE(a.passes, 200);
  EXPECT_TRUE(damped(played, played.asked.size() - 2));
}

TEST(FixedPoint, PassesAreNoMorePreciseThanGIsKnownAndPreciseInTheEnd) {
  const Vector g_star = vec({2});
  const ContactProblem p = nodes_apart(g_star);
  Played played(p, [&](const Vector& g) { return Vector(g_star - 0.5 * (g - g_star)); });
  const Settings settings = coulomb();
  const Solution a = fixed_point(p, settings, played, {});
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_GT(played.bounds.front(), 1e-3 * a.certificate.scale);
  for (std::size_t k = 1; k < played.bounds.size(); ++k) {
    EXPECT_LE(played.bounds[k], 2 * played.bounds[k - 1]);  // the scale moves a little
    const Real mismatch =
        norm_D(*p.system, vec({0, played.images[k - 1][0] - played.asked[k - 1][0]}));
    EXPECT_GE(played.bounds[k], 0.9 * std::min(played.bounds[0], 1e-3 * mismatch));
  }
}

TEST(FixedPoint, AnImageBelowThePrecisionOfItsPassDoesNotMisleadTheAcceleration) {
  // the first pass does nothing, as where sticking contact is within the first tolerance
  const Vector g_star = vec({2});
  const ContactProblem p = nodes_apart(g_star);
  int calls = 0;
  Played played(
      p, [&](const Vector& g) { return ++calls == 1 ? g : Vector(g_star - 0.5 * (g - g_star)); });
  const Settings settings = coulomb();
  const Solution a = fixed_point(p, settings, played, {});
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_LE(a.passes, 6);
}

TEST(FixedPoint, AFailedMinimizationNamesTheEnd) {
  const ContactProblem p = nodes_apart(vec({2}));
  class Failing final : public TrescaSolver {
   public:
    explicit Failing(Status status) : status_(status) {}
    Outcome minimize(Vector&, const Vector&, Real, Tangents, Real) override {
      return {status_, {}, {}};
    }

   private:
    Status status_;
  };
  for (Status status : {Status::max_iterations, Status::stagnated, Status::no_equilibrium,
                        Status::not_positive_definite}) {
    Failing failing(status);
    const Settings settings = coulomb();
    EXPECT_EQ(fixed_point(p, settings, failing, {}).status, status);
  }
}

TEST(FixedPoint, ASeparatedNodeHasNoLimitHoweverLargeMu) {
  // r_N of rounding size times mu was taken for friction: u_T = 0 where -0.3 is true
  DenseMatrix A(2, 2);
  A << 2, 0.3, 0.3, 1;
  const Vector F = vec({-1.5, 0.1}), free = A.lu().solve(F);
  for (Real mu : {1e2, 1e4, 1e6, 1e9})
    for (Method m : {Method::gc1, Method::gc2, Method::gc3, Method::gcx, Method::sorp}) {
      const ContactProblem p = ByHand(2, A, F).mu(mu).problem;
      Settings settings{m};
      for (const Vector& x0 : {Vector(), vec({-1, 0.5})}) {
        const Solution a = solve(p, settings, x0);
        EXPECT_EQ(a.status, Status::converged) << int(m) << " " << mu;
        EXPECT_LT((a.x - free).norm(), 1e-6 * free.norm()) << int(m) << " " << mu;
      }
    }
}

TEST(FixedPoint, ABoundOnTheIterationsHoldsForTheWholeCall) {
  const ContactProblem p = block(BlockOptions()).system().problem();
  for (Method m : {Method::gc1, Method::gc2, Method::gc3, Method::gcx, Method::sorp})
    for (Index bound : {1, 2, 7, 20}) {
      Settings settings{m};
      settings.nbiter = bound;
      const Solution a = solve(p, settings);
      EXPECT_LE(a.iterations, bound) << int(m);
      EXPECT_EQ(a.status, Status::max_iterations) << int(m);
      EXPECT_EQ(a.iterations, a.steps.total());
    }
}

TEST(FixedPoint, Step14ConvergesAtTheDefaultRegepsAndAtALargeOne) {
  for (int d : {2, 3})
    for (Regularization reg :
         {Regularization::polynomial, Regularization::square_root, Regularization::log_cosh}) {
      BlockOptions o;
      o.d = d;
      o.cells = d == 2 ? 8 : 3;
      o.clamp_side = true;
      o.shear = 8;
      const ContactProblem p = block(o).system().problem();
      Settings settings{Method::gc3};
      settings.reg = reg;
      settings.tol = 1e-7;
      settings.regeps = 1e-4;
      const Solution exact = solve(p, settings);
      settings.step = Step::newton;
      const Solution a = solve(p, settings);
      EXPECT_EQ(a.status, Status::regularized) << d << int(reg);  // eps limits both
      EXPECT_EQ(exact.status, Status::regularized);
      EXPECT_LT((a.x - exact.x).norm(), 1e-5 * exact.x.norm()) << d << int(reg);
      EXPECT_LE(a.iterations, 3 * exact.iterations) << d << int(reg);
      settings.regeps = 0;
      const Solution b = solve(p, settings);
      EXPECT_EQ(b.status, Status::converged) << d << int(reg);
    }
}

TEST(FixedPoint, EpsFollowsABodyThatSlidesFartherThanItSeemed) {
  BlockOptions o;
  o.cells = 8;
  o.clamp_side = true;
  o.shear = -20;
  o.mu = 0.2;
  const ContactProblem p = block(o).system().problem();
  Settings settings{Method::gc3};
  settings.tol = 1e-5;  // eps of 1e-8 max|x| is enough
  const Solution a = solve(p, settings);
  EXPECT_EQ(a.status, Status::converged);
  EXPECT_GE(a.eps, 0.4e-8 * a.x.lpNorm<Eigen::Infinity>());
  EXPECT_LE(a.eps, 1.1e-8 * a.x.lpNorm<Eigen::Infinity>());
}

TEST(FixedPoint, ATolThatRoundingForbidsEndsNamedAndSoon) {
  for (Method m : {Method::gc1, Method::gc2, Method::gc3, Method::gcx, Method::sorp})
    for (int d : {2, 3}) {
      BlockOptions o;
      o.d = d;
      o.cells = d == 2 ? 8 : 3;
      o.clamp_side = true;
      const ContactProblem p = block(o).system().problem();
      Settings settings{m};
      settings.tol = 1e-17;
      const Solution a = solve(p, settings);
      EXPECT_NE(a.status, Status::converged);
      EXPECT_NE(a.status, Status::max_iterations) << int(m) << d;
      EXPECT_LT(a.certificate.residual, 1e-10) << int(m) << d;
    }
}
