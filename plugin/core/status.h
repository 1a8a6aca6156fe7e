#pragma once

namespace frictioncg {

/// How a legal run ended. Illegal input is an exception.
enum class Status {
  converged = 0,
  max_iterations = 1,
  stagnated = 2,
  no_equilibrium = 3,
  not_positive_definite = 4,
  fixed_point_diverged = 5,
  regularized = 6  ///< the regularized problem is solved; regeps keeps the certificate above tol
};

}  // namespace frictioncg
