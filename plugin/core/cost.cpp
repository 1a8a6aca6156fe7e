#include "cost.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "statics/rigid_motions.h"

namespace frictioncg {

namespace {

// Fitted to tests/bench/routes.edp by routes.py, in seconds.
constexpr double of_factor = 1.2e-9;     ///< over n^2, contact dofs last, 3D
constexpr double of_factor_2d = 1.2e-7;  ///< over n^1.25, 2D
constexpr double of_entries = 5e-8;      ///< over the entries of A: ordering, and two sweeps
constexpr double of_laws = 4.5e-11;      ///< over contact_dofs^3: S, and ten steps on it
constexpr double of_cycles = 1.5e-7;     ///< over the entries of A: 15 to 30 cycles, and the set-up
constexpr double of_steps = 2.5e-7;      ///< over n^1.5: 20 factors of a slender body
constexpr double of_levels = 5e-8;       ///< over the entries of A: the set-up alone
/// From which on sparse factors cost no more than that, and hierarchies may be poor.
constexpr double slender = 30;

}  // namespace

Costs estimate_costs(const System& system) {
  Costs costs;
  const double n = system.dofs(), contact = system.contact_dofs();
  const double entries = double(system.entries().nonZeros());
  costs.condensed = of_laws * std::pow(contact, 3) + of_entries * entries +
                    (system.dimension == 3 ? of_factor * n * n : of_factor_2d * std::pow(n, 1.25));
  const bool known = system.rigid_modes && !system.mesh_node.empty();
  costs.multigrid = costs.sparse = std::numeric_limits<double>::infinity();
  if (known) costs.multigrid = of_cycles * entries;
  const double sparse = of_steps * std::pow(n, 1.5);
  if (std::max(costs.multigrid, sparse) < costs.condensed && slenderness(system) >= slender)
    costs.sparse = sparse;
  return costs;
}

double seconds_of_factor(const System& system) { return estimate_costs(system).condensed; }

double seconds_of_hierarchy(const System& system) {
  return of_levels * double(system.entries().nonZeros());
}

}  // namespace frictioncg
