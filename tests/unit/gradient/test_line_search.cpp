#include <gtest/gtest.h>

#include "core/gradient/line_search.h"
#include "recorder.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

struct Ray {
  ContactProblem p;
  Vector g, x, v;
  explicit Ray(int d, unsigned seed) {
    BlockOptions o;
    o.d = d;
    o.cells = d == 2 ? 6 : 2;
    p = block(o).system().problem();
    std::srand(seed);
    g = Vector::Random(p.nodes()).cwiseAbs() * 50;
    g[0] = 0;
    x = Vector::Random(p.dofs()) * 1e-3;
    v = Vector::Random(p.dofs()) * 1e-3;
    const int start = p.system->first[1] + 1;
    x.segment(start, p.tangents(1)) = -0.5 * v.segment(start, p.tangents(1));  // through the kink
  }
  Real J(const Phi& phi, Real rho) const { return energy(p, g, phi, x + rho * v); }
  Real a() const { return v.dot(p.increment.F - p.system->entries() * x); }
  Real slope(const Phi& phi, Real rho) const {
    const Vector y = x + rho * v;
    Real sum = v.dot(p.system->entries() * y - p.increment.F);
    for (Index i = 0; i < p.nodes(); ++i)
      sum += g[i] * phi.slope_over_t(tangential_norm(*p.system, i, y)) *
             y.segment(p.system->first[i] + 1, p.tangents(i))
                 .dot(v.segment(p.system->first[i] + 1, p.tangents(i)));
    return sum;
  }
};

/// The line as search wants it, down the slope.
struct Descent {
  Ray line;
  Real r_v = 0;
  Curvature vAv;
  Descent(int d, unsigned seed, const Phi& phi) : line(d, seed) {
    r_v = -line.slope(phi, 0);
    if (r_v < 0) line.v = -line.v, r_v = -r_v;
    vAv = {line.v.dot(line.p.system->entries() * line.v), line.v.squaredNorm()};
  }
  Real step(LineSearch& search, const Phi& phi, Real rho_max = 1e300) {
    return search(phi, line.g, line.x, line.v, {r_v, line.a(), vAv}, rho_max);
  }
};

}  // namespace

TEST(LineSearch, ExactStepIsARootOfTheSlopeForEachRegularization) {
  for (int d : {2, 3})
    for (unsigned seed = 1; seed <= 20; ++seed)
      for (Regularization kind :
           {Regularization::polynomial, Regularization::square_root, Regularization::log_cosh})
        for (Real eps : {1e-10, 1e-5, 1e-3}) {
          const Phi phi{kind, eps};
          Descent c(d, seed, phi);
          LineSearch search(*c.line.p.system, Step::exact);
          const Real rho = c.step(search, phi);
          // the slope changes sign at rho, to the rounding of rho
          EXPECT_LE(c.line.slope(phi, rho * (1 - 1e-9)), 1e-7 * c.r_v);
          EXPECT_GE(c.line.slope(phi, rho * (1 + 1e-9)), -1e-7 * c.r_v);
          EXPECT_LT(c.line.J(phi, rho), c.line.J(phi, 0));
        }
}

TEST(LineSearch, NewtonStepIsEquation14) {
  const Phi phi{Regularization::square_root, 1e-3};
  Descent c(2, 3, phi);
  const Real h = 1e-6;
  const Real J2 = (c.line.slope(phi, h) - c.line.slope(phi, -h)) / (2 * h);
  LineSearch newton(*c.line.p.system, Step::newton);
  EXPECT_NEAR(c.step(newton, phi), c.r_v / J2, 1e-6 * c.r_v / J2);
}

TEST(LineSearch, StopsAtTheGapAndSeesARigidMotionThatNothingBrakes) {
  Ray line(2, 3);
  const Phi phi{Regularization::polynomial, 1e-8};
  LineSearch search(*line.p.system, Step::exact);
  const Curvature vAv{line.v.dot(line.p.system->entries() * line.v), line.v.squaredNorm()};
  EXPECT_EQ(search(phi, Vector::Zero(line.p.nodes()), line.x, line.v, {1, 1, vAv}, 1e-12), 1e-12);
  line.v.setConstant(1e-3);
  Real brake = 0;
  for (Index i = 0; i < line.p.nodes(); ++i) brake += line.g[i] * 1e-3;
  line.x.setZero();
  const Curvature rigid{1e-15, 1};  // zero but for rounding
  EXPECT_TRUE(std::isinf(
      search(phi, line.g, line.x, line.v, {1.01 * brake, 1.01 * brake, rigid}, INFINITY)));
  EXPECT_TRUE(std::isfinite(
      search(phi, line.g, line.x, line.v, {0.99 * brake, 0.99 * brake, rigid}, INFINITY)));
}

TEST(LineSearch, FalsePositionComesWithinItsToleranceOfTheExactStepFromEitherSide) {
  for (int d : {2, 3})
    for (unsigned seed = 1; seed <= 20; ++seed)
      for (Real eps : {1e-4, 1e-5}) {
        const Phi phi{Regularization::polynomial, eps};
        Descent down(d, seed, phi);
        LineSearch exact(*down.line.p.system, Step::exact),
            approximate(*down.line.p.system, Step::false_position);
        const Real rho = down.step(exact, phi);
        EXPECT_NEAR(down.step(approximate, phi), rho, 1e-3 * rho) << d << " " << seed << " " << eps;
      }
}

TEST(LineSearch, WithoutRegularizationItFindsTheMinimumBetweenAndAtTheKinks) {
  const Phi phi{Regularization::polynomial, 0};
  for (int d : {2, 3})
    for (unsigned seed = 1; seed <= 40; ++seed) {
      Descent c(d, seed, phi);
      // some nodes past their kink from the start, some ahead of it, one that starts in it
      for (Index i = 2; i < c.line.p.nodes(); ++i) {
        const Index T = c.line.p.system->first[i] + 1, t = c.line.p.tangents(i);
        const Real s = i % 3 == 0 ? 1.5 : i % 3 == 1 ? -1e-3 : -0.2;
        c.line.x.segment(T, t) = s * c.line.v.segment(T, t);
      }
      c.r_v = -c.line.slope(phi, 0);
      if (c.r_v <= 0) continue;
      LineSearch search(*c.line.p.system, Step::exact);
      const Real rho = c.step(search, phi), J = c.line.J(phi, rho);
      EXPECT_LT(J, c.line.J(phi, 0));
      for (Real other : {0.5, 0.9, 0.999, 1.001, 1.1, 2.0})
        EXPECT_LE(J, c.line.J(phi, other * rho) + 1e-13 * std::abs(J)) << d << " " << seed;
    }
}

TEST(LineSearch, EveryStepStopsAtTheGap) {
  for (int d : {2, 3})
    for (Step step : {Step::exact, Step::newton, Step::false_position})
      for (bool safeguarded : {true, false})
        for (Regularization kind : {Regularization::polynomial, Regularization::square_root}) {
          const Phi phi{kind, 1e-4};
          Descent c(d, 2, phi);
          LineSearch search(*c.line.p.system, step, safeguarded);
          const Real rho = c.step(search, phi);
          EXPECT_LE(c.step(search, phi, 0.3 * rho), 0.3 * rho) << int(step);
          EXPECT_GT(c.step(search, phi, 0.3 * rho), 0);
          c.line.g.setZero();  // and where nothing brakes
          c.r_v = -c.line.slope(phi, 0);
          if (!(c.r_v > 0)) continue;
          EXPECT_EQ(c.step(search, phi, 1e-9), 1e-9) << int(step);
        }
}

TEST(LineSearch, Step14ThatOvershootsAKinkIsShortenedSoThatJFalls) {
  Index shortened = 0;
  for (int d : {2, 3})
    for (unsigned seed = 1; seed <= 40; ++seed)
      for (Real eps : {1e-9, 1e-6, 1e-4}) {
        const Phi phi{Regularization::polynomial, eps};
        Descent c(d, seed, phi);
        LineSearch printed(*c.line.p.system, Step::newton, false),
            safe(*c.line.p.system, Step::newton);
        const Real rho = c.step(safe, phi), as_printed = c.step(printed, phi);
        EXPECT_LE(c.line.J(phi, rho), c.line.J(phi, 0)) << d << " " << seed << " " << eps;
        EXPECT_LE(rho, as_printed * (1 + 1e-12));
        shortened += rho < as_printed * (1 - 1e-3);
      }
  EXPECT_GT(shortened, 0);
}
