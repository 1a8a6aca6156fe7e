#include "model/contact_problem.h"

#include <cmath>

namespace frictioncg {

Real norm_D(const System& system, const Vector& r) {
  return std::sqrt((r.array().square() / system.weight.array()).sum());
}

Real load_norm(const System& system, const Vector& F, const Vector& gap) {
  const Real load = norm_D(system, F);
  if (load > 0) return load;
  Real penetration = 0;
  for (Index i = 0; i < system.nodes(); ++i) {
    const Real depth = std::min(gap[i], 0.0);
    penetration += system.weight[system.first[i]] * depth * depth;
  }
  return penetration > 0 ? std::sqrt(penetration) : 1;
}

}  // namespace frictioncg
