#pragma once
#include "model/system.h"

namespace frictioncg {

/// About what the routes cost on a system, in seconds of one core that factors 1e10 flops a second:
/// good for their ratio. Known before anything is ordered, since ordering alone costs as much as
/// the multigrid route in 3D.
struct Costs {
  double condensed = 0;
  double multigrid = 0;  ///< infinite where the system does not tell nodes and rigid modes
  double path = 0;       ///< central path, on A or on the contact dofs; infinite where not slender
  double sparse = 0;     ///< the same on A; infinite where that is no better than another
  /// Newton's method on sparse factors may cost less than by multigrid: not in 3D, where it takes
  /// twice as long on bars, and on plates the ordering alone takes as long as all of multigrid.
  bool sparse_first = false;
};

Costs estimate_costs(const System& system);

/// The factor is taken up to so many times what multigrid costs: in 2D its answer has five digits
/// more, and it serves all increments that follow. In 3D it grows with n^2. On slender bodies
/// Newton's method often fails on S, and takes a central path there.
inline double worth_of_factor(const System& system, const Costs& costs) {
  return system.dimension == 2 && std::isinf(costs.sparse) ? 4 : 1;
}

/// About the seconds of its set-up, which nothing interrupts.
double seconds_of_hierarchy(const System& system);

}  // namespace frictioncg
