#include "model/certificate.h"

#include <cmath>

namespace frictioncg {

Real sliding_limit(const ContactProblem& problem, Index i, const Vector& r) {
  switch (problem.law) {
    case Law::frictionless:
      return 0;
    case Law::tresca:
      return problem.g[i];
    case Law::coulomb: {
      const Real r_N = r[problem.first[i]];
      return problem.mu[i] * (problem.bilateral ? std::abs(r_N) : std::max(r_N, 0.0));
    }
  }
  return 0;
}

namespace {

/// One scalar per node, so that the law is the same in every tangential frame.
Real tangential_stiffness(const ContactProblem& problem, Index i, const Vector& D) {
  return D.segment(problem.first[i] + 1, problem.tangents(i)).mean();
}

/// A gap below this, in the units of the certificate, is closed: rounding does not decide on a node
/// that grazes, as the vertices of P2 do under a uniform pressure in 3D.
constexpr Real grazing = 1e-10;

}  // namespace

Certificate certify(const ContactProblem& problem, const Vector& x) {
  const Vector& D = problem.D;
  Certificate c;
  c.r = problem.F - problem.A * x;

  const Index interior = problem.interior();
  c.equilibrium = (c.r.head(interior).array().square() / D.head(interior).array()).sum();
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = problem.first[i];
    const Real gap_left = D[N] * (problem.gap[i] - x[N]);
    const Real law = problem.bilateral ? gap_left : std::min(gap_left, c.r[N]);
    c.normal += law * law / D[N];

    const Index t = problem.tangents(i);
    if (t == 0) continue;
    const Real c_T = tangential_stiffness(problem, i, D);
    const Real g = sliding_limit(problem, i, c.r);
    const auto r_T = c.r.segment(N + 1, t);
    const auto x_T = x.segment(N + 1, t);
    const Real y = (r_T + c_T * x_T).norm();
    if (y <= g)
      c.friction += c_T * x_T.squaredNorm();
    else
      c.friction += (r_T - (g / y) * (r_T + c_T * x_T)).squaredNorm() / c_T;
  }
  c.residual = std::sqrt(c.equilibrium + c.normal + c.friction) / problem.force_scale;
  c.equilibrium = std::sqrt(c.equilibrium) / problem.force_scale;
  c.normal = std::sqrt(c.normal) / problem.force_scale;
  c.friction = std::sqrt(c.friction) / problem.force_scale;
  return c;
}

std::vector<NodeState> classify(const ContactProblem& problem, const Vector& x, const Vector& r) {
  const Vector& D = problem.D;
  std::vector<NodeState> state(problem.nodes());
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = problem.first[i];
    const Index t = problem.tangents(i);
    const Real gap_left = D[N] * (problem.gap[i] - x[N]);
    const bool touches = gap_left <= grazing * std::sqrt(D[N]) * problem.force_scale;
    if (!problem.bilateral && !touches && (r[N] <= gap_left || r[N] <= 0)) {
      state[i] = NodeState::separated;
    } else if (t == 0) {  // Dirichlet conditions hold its tangents, or it has no friction
      const bool friction =
          problem.law == Law::tresca || (problem.law == Law::coulomb && problem.mu[i] > 0);
      state[i] = friction ? NodeState::stick : NodeState::slip;
    } else {
      const Real c_T = tangential_stiffness(problem, i, D);
      const Real y = (r.segment(N + 1, t) + c_T * x.segment(N + 1, t)).norm();
      state[i] = y <= sliding_limit(problem, i, r) ? NodeState::stick : NodeState::slip;
    }
  }
  return state;
}

}  // namespace frictioncg
