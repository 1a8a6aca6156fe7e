#pragma once
#include "model/system.h"

namespace frictioncg {

/// About what the routes cost on a system, in seconds of one core that factors 1e10 flops a second:
/// good for their ratio. Known before anything is ordered, since ordering alone costs as much as
/// the multigrid route in 3D.
struct Costs {
  double condensed = 0;
  double multigrid = 0;  ///< infinite where the system does not tell nodes and rigid modes
  double sparse = 0;     ///< infinite where bodies are not slender
};

/// Measured on P1 blocks of 14 000 to 114 000 dofs, with a margin for harder scenes. In 3D a factor
/// grows with n^2; in 2D it grows no faster than what multigrid takes in practice, so that there
/// only the dense matrices on the contact dofs count against it.
Costs estimate_costs(const System& system);

/// About the seconds of what nothing interrupts: ordering, factorization and condensation, and the
/// set-up of a hierarchy.
double seconds_of_factor(const System& system);
double seconds_of_hierarchy(const System& system);

}  // namespace frictioncg
