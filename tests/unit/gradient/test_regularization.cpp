#include <gtest/gtest.h>

#include "core/gradient/regularization.h"

using namespace frictioncg;

namespace {
const Regularization all_kinds[] = {Regularization::square_root, Regularization::log_cosh,
                                    Regularization::polynomial};
const Real points[] = {0.1, 0.9, 1.1, 3, 40};  // in units of eps, both sides of it

Real slope(const Phi& phi, Real t) { return t * phi.slope_over_t(t); }
}  // namespace

TEST(Regularization, SlopeMatchesACentredDifferenceOnBothSidesOfEps) {
  for (Regularization kind : all_kinds)
    for (Real eps : {1e-8, 1.0, 1e6})
      for (Real t : points) {
        const Phi phi{kind, eps};
        const Real h = 1e-5 * eps;
        const Real difference = (phi.value(t * eps + h) - phi.value(t * eps - h)) / (2 * h);
        EXPECT_NEAR(slope(phi, t * eps), difference, 1e-8);
      }
}

TEST(Regularization, CurvatureMatchesACentredDifferenceOfTheSlope) {
  for (Regularization kind : all_kinds)
    for (Real t : points) {
      const Phi phi{kind, 2.0};
      const Real h = 1e-5;
      EXPECT_NEAR(phi.second_derivative(2 * t),
                  (slope(phi, 2 * t + h) - slope(phi, 2 * t - h)) / (2 * h), 1e-8);
    }
}

TEST(Regularization, StaysWithinItsBoundOfTheAbsoluteValue) {
  const Real constant[] = {1, std::log(2.0), 0.5};
  for (int k = 0; k < 3; ++k)
    for (Real t = 0; t < 20; t += 0.01) {
      const Phi phi{all_kinds[k], 1.0};
      EXPECT_LE(std::abs(t - phi.value(t)), constant[k] + 1e-14);
    }
}

TEST(Regularization, StartsAtItsLeastAndHasNoJumpWhereItsFormChanges) {
  for (Regularization kind : all_kinds) {
    const Phi phi{kind, 1.0};
    EXPECT_NEAR(phi.value(0), kind == Regularization::square_root ? 1 : 0, 1e-15);
    EXPECT_NEAR(phi.value(1 - 1e-9), phi.value(1 + 1e-9), 3e-9);
  }
}

TEST(Regularization, ItsMeanCurvatureIsHalfTheTraceOfItsHessianInThePlane) {
  for (Regularization kind : all_kinds)
    for (Real t : {0.3, 3.0}) {
      const Phi phi{kind, 1.0};
      const Real h = 1e-4;
      const auto J = [&](Real x, Real y) { return phi.value(std::hypot(x, y)); };
      const Real trace = (J(t + h, 0) + J(t - h, 0) + J(t, h) + J(t, -h) - 4 * J(t, 0)) / (h * h);
      EXPECT_NEAR(phi.mean_second_derivative(t, 2), trace / 2, 1e-6);
      EXPECT_EQ(phi.mean_second_derivative(t, 1), phi.second_derivative(t));
    }
}

TEST(Regularization, IsFiniteAtZeroAtEpsAndFarOut) {
  for (Regularization kind : all_kinds)
    for (Real t : {0.0, 1e-14, 1.0, 1e14}) {
      const Phi phi{kind, 1e-8};
      EXPECT_TRUE(std::isfinite(phi.value(t)));
      EXPECT_TRUE(std::isfinite(phi.slope_over_t(t)));
      EXPECT_TRUE(std::isfinite(phi.second_derivative(t)));
      EXPECT_LE(slope(phi, t), 1 + 1e-14);
    }
}

TEST(Regularization, StickPatchSlipsByTheClosedForm) {
  // phi'(t) = s is where a node under the shear s g comes to rest
  for (Real s : {0.1, 0.5, 0.9}) {
    EXPECT_NEAR((slope(Phi{Regularization::polynomial, 1.0}, s)), s, 1e-14);
    EXPECT_NEAR((slope(Phi{Regularization::square_root, 1.0}, s / std::sqrt(1 - s * s))), s, 1e-14);
    EXPECT_NEAR((slope(Phi{Regularization::log_cosh, 1.0}, std::atanh(s))), s, 1e-14);
  }
}
