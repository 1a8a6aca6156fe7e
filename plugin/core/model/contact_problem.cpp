#include "model/contact_problem.h"

#include <cmath>

namespace frictioncg {

Real norm_D(const ContactProblem& problem, const Vector& r) {
  return std::sqrt((r.array().square() / problem.D.array()).sum());
}

Real load_norm(const ContactProblem& problem) {
  const Real load = norm_D(problem, problem.F);
  if (load > 0) return load;
  Real penetration = 0;
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Real depth = std::min(problem.gap[i], 0.0);
    penetration += problem.D[problem.first[i]] * depth * depth;
  }
  return penetration > 0 ? std::sqrt(penetration) : 1;
}

}  // namespace frictioncg
