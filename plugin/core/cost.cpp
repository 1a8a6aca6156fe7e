#include "cost.h"

namespace frictioncg {

namespace {

// Fitted to tests/bench/routes.edp by routes.py, in seconds.
constexpr double of_factor = 1.2e-9;     ///< over n^2, contact dofs last, 3D
constexpr double of_factor_2d = 1.2e-7;  ///< over n^1.25, 2D, in any order
constexpr double of_sparse = 4e-8;       ///< over n^1.5, 3D: slender bodies, in the best order
constexpr double of_entries = 5e-8;      ///< over the entries of A: ordering, and two sweeps
constexpr double of_laws = 4.5e-11;      ///< over contact_dofs^3: S, and ten Newton steps on it
constexpr double of_cycles = 1.15e-7;    ///< over the entries of A: 15 to 30 cycles, and the set-up
constexpr double of_levels = 5e-8;       ///< over the entries of A: the set-up alone
/// A central path takes up to 40 steps, Newton's after it included. On A all of it costs about as
/// much as 15 sparse factors with their ordering, on S six times what Newton's method does there.
/// In 2D Newton's method on A costs as much as 6, and where it takes many steps on S that is 12.
constexpr double steps_on_A = 15, steps_on_A_2d = 6, path_on_S = 6, path_on_S_2d = 12;
/// From this slenderness on hierarchies may be poor, and sparse factors are looked at. A plate or a
/// beam of one layer of elements has 0.58 L/t, of two 0.7.
constexpr double slender = 20, slender_2d = 12;

}  // namespace

Costs estimate_costs(const System& system) {
  Costs costs;
  const double n = system.dofs(), contact = system.contact_dofs();
  const double entries = double(system.entries().nonZeros());
  const double ordered = of_entries * entries, planar = of_factor_2d * std::pow(n, 1.25);
  const double laws = of_laws * std::pow(contact, 3);
  const bool solid = system.dimension == 3;
  costs.condensed = laws + ordered + (solid ? of_factor * n * n : planar);
  const bool known = system.rigid_modes && !system.mesh_node.empty();
  const auto is_slender = [&] {
    return system.slenderness && system.slenderness() >= (solid ? slender : slender_2d);
  };
  costs.multigrid = costs.path = costs.sparse = std::numeric_limits<double>::infinity();
  if (known) costs.multigrid = of_cycles * entries;
  const double on_A = solid ? steps_on_A * (ordered + of_sparse * std::pow(n, 1.5))
                            : steps_on_A_2d * (ordered + planar);
  const double on_S = costs.condensed + ((solid ? path_on_S : path_on_S_2d) - 1) * laws;
  if (costs.multigrid < costs.condensed && is_slender()) costs.path = std::min(on_A, on_S);
  if (costs.path == on_A) costs.sparse = on_A;
  costs.sparse_first = std::isfinite(costs.sparse) && !solid;
  return costs;
}

double seconds_of_hierarchy(const System& system) {
  return of_levels * double(system.entries().nonZeros());
}

}  // namespace frictioncg
