#include "model/certificate.h"

#include <cmath>

namespace frictioncg {

namespace {

/// One scalar per node, so that the law is the same in every tangential frame.
Real tangential_stiffness(const System& system, Index i) {
  return system.D.segment(system.first[i] + 1, system.tangents(i)).mean();
}

/// A gap below this, in the units of the certificate, is closed: rounding does not decide on a node
/// that grazes, as the vertices of P2 do under a uniform pressure in 3D.
constexpr Real grazing = 1e-10;

}  // namespace

Certificate certify(const ContactProblem& problem, const Vector& x) {
  const Vector& D = problem.system->D;
  Certificate c;
  c.r = problem.increment.F - problem.system->A * x;

  const Index interior = problem.interior();
  c.equilibrium = (c.r.head(interior).array().square() / D.head(interior).array()).sum();
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = problem.system->first[i], t = problem.tangents(i);
    const NodeLaw law = law_of(problem.increment, i);
    const Real closing = D[N] * (problem.increment.gap[i] - x[N]);
    const Real normal = law.normal_residual(closing, c.r[N]);
    c.normal += normal * normal / D[N];
    if (t == 0) continue;
    const Real c_T = tangential_stiffness(*problem.system, i);
    const Tangent friction =
        friction_residual(c.r.segment(N + 1, t), x.segment(N + 1, t), c_T, law.limit(c.r[N]));
    c.friction += friction.squaredNorm() / c_T;
  }
  c.residual = std::sqrt(c.equilibrium + c.normal + c.friction) / problem.increment.force_scale;
  c.equilibrium = std::sqrt(c.equilibrium) / problem.increment.force_scale;
  c.normal = std::sqrt(c.normal) / problem.increment.force_scale;
  c.friction = std::sqrt(c.friction) / problem.increment.force_scale;
  return c;
}

std::vector<NodeState> classify(const ContactProblem& problem, const Vector& x, const Vector& r) {
  const Vector& D = problem.system->D;
  std::vector<NodeState> state(problem.nodes());
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = problem.system->first[i];
    const Index t = problem.tangents(i);
    const NodeLaw law = law_of(problem.increment, i);
    const Real closing = D[N] * (problem.increment.gap[i] - x[N]);
    const bool touches = closing <= grazing * std::sqrt(D[N]) * problem.increment.force_scale;
    if (!law.closed(closing, r[N]) && !touches) {
      state[i] = NodeState::separated;
    } else if (t == 0) {  // Dirichlet conditions hold its tangents, or it has no friction
      state[i] = law.has_friction() ? NodeState::stick : NodeState::slip;
    } else {
      const Real c_T = tangential_stiffness(*problem.system, i);
      const Real y = (r.segment(N + 1, t) + c_T * x.segment(N + 1, t)).norm();
      state[i] = y <= law.limit(r[N]) ? NodeState::stick : NodeState::slip;
    }
  }
  return state;
}

}  // namespace frictioncg
