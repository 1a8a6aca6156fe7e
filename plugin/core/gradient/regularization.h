#pragma once
#include "settings.h"

namespace frictioncg {

/// phi_eps of section 4.1: |x_T| made differentiable. t = |x_T| >= 0 and eps > 0 are lengths.
///   gradient  phi'(|x|) x/|x|  = slope_over_t(t) x
///   Hessian   phi''(t) dd' + phi'(t)/t (I - dd'),  d = x/|x|
/// All three stay finite at t = 0 and far out. The polynomial with eps = 0 is |x| itself, away from
/// 0.
struct Phi {
  /// t/eps below which tanh(t/eps)/t is 1/eps: the next term, (t/eps)^2/3, is 3e-9 of it.
  static constexpr Real straight = 1e-4;

  Regularization kind = Regularization::polynomial;
  Real eps = 0;

  Real value(Real t) const {
    switch (kind) {
      case Regularization::square_root:
        return std::hypot(t, eps);    // REG1, eq. (7)
      case Regularization::log_cosh:  // REG2, eq. (8)
        return t + eps * std::log1p(std::exp(-2 * t / eps)) - eps * std::log(2.0);
      case Regularization::polynomial:  // REG3, eq. (9)
        return eps > 0 && t <= eps ? t * (t / eps) / 2 : t - eps / 2;
    }
    return t;
  }

  Real slope_over_t(Real t) const {
    switch (kind) {
      case Regularization::square_root:
        return 1 / std::hypot(t, eps);
      case Regularization::log_cosh:
        return t < straight * eps ? 1 / eps : std::tanh(t / eps) / t;
      case Regularization::polynomial:
        return t > 0 || eps > 0 ? 1 / std::max(t, eps) : 0;
    }
    return 0;
  }

  Real second_derivative(Real t) const {
    switch (kind) {
      case Regularization::square_root: {
        const Real h = std::hypot(t, eps);
        return (eps / h) * (eps / h) / h;
      }
      case Regularization::log_cosh: {
        const Real e = std::exp(-2 * t / eps);  // 1/cosh^2 without overflow
        return 4 * e / ((1 + e) * (1 + e)) / eps;
      }
      case Regularization::polynomial:
        return eps > 0 && t <= eps ? 1 / eps : 0;
    }
    return 0;
  }

  /// phi''(x_T) averaged over the tangential directions: the diagonal of (17), the same in each
  /// frame.
  Real mean_second_derivative(Real t, Index tangents) const {
    return (second_derivative(t) + (tangents - 1) * slope_over_t(t)) / tangents;
  }
};

}  // namespace frictioncg
