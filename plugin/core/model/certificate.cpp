#include "model/certificate.h"

#include <cmath>

namespace frictioncg {

namespace {

/// A gap below this, in the units of the certificate, is closed: rounding does not decide on a node
/// that grazes, as the vertices of P2 do under a uniform pressure in 3D.
constexpr Real grazing = 1e-10;

}  // namespace

Certificate certify(const ContactProblem& problem, const Vector& x) {
  const Vector& w = problem.system->weight;
  Certificate c;
  c.r = problem.increment.F - problem.system->A * x;

  const Index interior = problem.interior();
  c.equilibrium = (c.r.head(interior).array().square() / w.head(interior).array()).sum();
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = problem.system->first[i], t = problem.tangents(i);
    const NodeLaw law = law_of(problem.increment, i);
    const Real closing = w[N] * (problem.increment.gap[i] - x[N]);
    const Real normal = law.normal_residual(closing, c.r[N]);
    c.normal += normal * normal / w[N];
    if (t == 0) continue;
    const Real c_T = w[N + 1];
    const Tangent friction =
        friction_residual(c.r.segment(N + 1, t), x.segment(N + 1, t), c_T, law.limit(c.r[N]));
    c.friction += friction.squaredNorm() / c_T;
  }
  c.scale = problem.increment.force_scale;
  c.residual = std::sqrt(c.equilibrium + c.normal + c.friction) / c.scale;
  c.equilibrium = std::sqrt(c.equilibrium) / c.scale;
  c.normal = std::sqrt(c.normal) / c.scale;
  c.friction = std::sqrt(c.friction) / c.scale;
  return c;
}

std::vector<NodeState> classify(const ContactProblem& problem, const Vector& x,
                                const Certificate& certificate) {
  const Vector& r = certificate.r;
  const Vector& w = problem.system->weight;
  std::vector<NodeState> state(problem.nodes());
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = problem.system->first[i];
    const Index t = problem.tangents(i);
    const NodeLaw law = law_of(problem.increment, i);
    const Real closing = w[N] * (problem.increment.gap[i] - x[N]);
    const bool touches = closing <= grazing * std::sqrt(w[N]) * certificate.scale;
    if (!law.closed(closing, r[N]) && !touches) {
      state[i] = NodeState::separated;
    } else if (t == 0) {  // Dirichlet conditions hold its tangents, or it has no friction
      state[i] = law.has_friction() ? NodeState::stick : NodeState::slip;
    } else {
      const Real c_T = w[N + 1];
      const Real y = (r.segment(N + 1, t) + c_T * x.segment(N + 1, t)).norm();
      state[i] = y <= law.limit(r[N]) ? NodeState::stick : NodeState::slip;
    }
  }
  return state;
}

}  // namespace frictioncg
