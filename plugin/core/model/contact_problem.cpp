#include "model/contact_problem.h"

namespace frictioncg {

Real ContactProblem::closing(Index i, const Vector& x) const {
  const Index N = system->first[i];
  return system->weight[N] * (increment.gap[i] - x[N]);
}

Real norm_D(const System& system, const Vector& r) {
  return std::sqrt(system.sum((r.array().square() / system.weight.array()).sum()));
}

Real driving_norm(const System& system, const Increment& increment) {
  const Real load = norm_D(system, increment.F);
  return load > 0 ? load : closing_norm(system, increment);
}

Real closing_norm(const System& system, const Increment& increment) {
  Real closing = 0;
  for (Index i = 0; i < system.nodes(); ++i) {
    const Real gap = increment.gap[i], depth = increment.bilateral ? gap : std::min(gap, 0.0);
    closing += system.weight[system.first[i]] * depth * depth;
  }
  return std::sqrt(system.sum(closing));
}

Vector limits_of_stick(const ContactProblem& problem) {
  const System& system = *problem.system;
  const Real most = 1e6 * driving_norm(system, problem.increment);
  Vector g = Vector::Zero(problem.nodes());
  for (Index i = 0; i < problem.nodes(); ++i)
    if (std::isfinite(problem.increment.gap[i]))
      g[i] = most * std::sqrt(system.weight[system.first[i]]);
  return g;
}

}  // namespace frictioncg
