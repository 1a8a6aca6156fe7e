#include "cost.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "statics/slenderness.h"

namespace frictioncg {

namespace {

constexpr double of_factor = 1.2e-9;  ///< s over n^2, contact dofs last, 3D
constexpr double of_laws = 5e-10;     ///< s over contact_dofs^3: S, and ten steps on it
constexpr double of_cycles = 2.5e-7;  ///< s over the entries of A: 30 to 60 cycles, and the set-up
constexpr double of_steps = 4e-7;     ///< s over n^1.5: 20 factors of a slender body
/// From which on such factors cost no more than that, and hierarchies may be poor.
constexpr double slender = 30;
constexpr double of_factor_2d = 1.5e-8;  ///< s over n^1.5, 2D
constexpr double of_levels = 5e-8;       ///< s over the entries of A: the set-up alone

}  // namespace

Costs estimate_costs(const System& system) {
  Costs costs;
  const double n = system.dofs(), contact = system.contact_dofs();
  if (system.dimension == 3) costs.condensed = of_factor * n * n;
  costs.condensed += of_laws * std::pow(contact, 3);
  const bool known = system.rigid_modes && !system.mesh_node.empty();
  costs.multigrid = costs.sparse = std::numeric_limits<double>::infinity();
  if (known) costs.multigrid = of_cycles * double(system.entries().nonZeros());
  const double sparse = of_steps * std::pow(n, 1.5);
  if (std::max(costs.multigrid, sparse) < costs.condensed && slenderness(system) >= slender)
    costs.sparse = sparse;
  return costs;
}

double seconds_of_factor(const System& system) {
  const double n = system.dofs();
  return estimate_costs(system).condensed +
         (system.dimension == 2 ? of_factor_2d * std::pow(n, 1.5) : 0);
}

double seconds_of_hierarchy(const System& system) {
  return of_levels * double(system.entries().nonZeros());
}

}  // namespace frictioncg
