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
  regularized = 6,  ///< the regularized problem is solved; regeps keeps the certificate above tol
  /// The laws hold, and a body has turned by more than small rotations can mean, though neither
  /// supports nor friction hold it. Said by whoever knows where the nodes are: not by this core.
  runaway = 7
};

/// In words, in their order.
inline constexpr const char* status_names[] = {"converged",
                                               "max_iterations",
                                               "stagnated",
                                               "no_equilibrium",
                                               "not_positive_definite",
                                               "fixed_point_diverged",
                                               "regularized",
                                               "runaway"};

static_assert(sizeof(status_names) / sizeof(*status_names) ==
              static_cast<int>(Status::runaway) + 1);

constexpr const char* name_of(Status status) { return status_names[static_cast<int>(status)]; }

}  // namespace frictioncg
