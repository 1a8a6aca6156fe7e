#include "model/certificate.h"

#include <tuple>

namespace frictioncg {

namespace {

/// Forces below this many times the rounding of Ax are taken as rounding: solvers stop a little
/// above it.
constexpr Real rounding_margin = 10;

/// x may meet a load that was rounded, and miss the load that was meant. What is rounded adds up to
/// about this share of its bound.
constexpr Real unknown_share = 0.1;

/// The share of the load that counts beside the contact forces: small enough that tol bounds the
/// laws to 100 tol of contact forces down to 1e-4 of the load, large enough for those to vanish.
/// Where nothing touches the load counts in full.
constexpr Real load_share = 0.01;

/// Gaps and forces below this, over the scale, cannot be told from 0: rounding does not decide on a
/// node that grazes. Less precise answers leave more in doubt, up to `vaguest`.
constexpr Real grazing = 1e-10, vaguest = 1e-6;

/// Motion below this, over the scale, is no sliding: above eps of the regularized methods, 1e-8 of
/// the displacement.
constexpr Real still = 1e-6;

/// Norm of the forces of the nodes that are closed: an open node's r is an error, not a force.
Real contact_force_norm(const ContactProblem& problem, const Vector& x, const Vector& r) {
  Real sum = 0;
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = problem.system->first[i], size = problem.tangents(i) + 1;
    if (!law_of(problem.increment, i).closed(problem.closing(i, x), r[N])) continue;
    sum += (r.segment(N, size).array().square() / problem.system->weight.segment(N, size).array())
               .sum();
  }
  return std::sqrt(problem.system->sum(sum));
}

/// The force, in norm_D, that would close the nearest gap.
Real nearest_gap(const ContactProblem& problem, const Vector& x) {
  Real nearest = infinity;
  for (Index i = 0; i < problem.nodes(); ++i)
    nearest = std::min(nearest, std::abs(problem.closing(i, x)) /
                                    std::sqrt(problem.system->weight[problem.system->first[i]]));
  return -problem.system->largest(-nearest);
}

struct Scale {
  Real size;     ///< > 0
  Real unknown;  ///< of the residual, where it is measured in forces
};
/// What the residual of x is measured in.   violation: its norm; rounding: that of r
Scale scale_of(const ContactProblem& problem, const Vector& x, const Vector& r, Real violation,
               Real rounding) {
  const Increment& increment = problem.increment;
  const Real load = increment.load_that_counts(rounding);
  const Real contact = contact_force_norm(problem, x, r);
  if (std::hypot(load, contact) > rounding_margin * rounding)
    return {std::max(forces_at_work(load, contact), rounding), unknown_share * increment.rounding};
  const Real driving =
      std::max(driving_norm(*problem.system, increment), norm_D(*problem.system, increment.F - r));
  if (violation > rounding_margin * rounding)
    return {std::max(violation, std::min(driving, nearest_gap(problem, x))), 0};
  return {driving > 0 ? driving : 1, 0};
}

}  // namespace

bool may_be_rounding(const Certificate& certificate) {
  return certificate.residual <= rounding_margin * certificate.attainable;
}

Real forces_at_work(Real load, Real contact) {
  return std::hypot(contact > 0 ? load_share * load : load, contact);
}

Certificate certify(const ContactProblem& problem, const Vector& x) {
  const Vector& w = problem.system->weight;
  Certificate c;
  const Vector magnitude = problem.system->multiply_sized(x, c.r);
  c.r = problem.increment.F - c.r;
  const Real rounding =
      std::hypot(problem.increment.rounding, epsilon * norm_D(*problem.system, magnitude));

  const Index interior = problem.interior();
  c.equilibrium = (c.r.head(interior).array().square() / w.head(interior).array()).sum();
  const Violation of_laws = frictioncg::violation(problem, w, x, c.r);
  Real squares[] = {c.equilibrium, of_laws.normal, of_laws.friction};
  problem.system->sum(squares, 3);
  std::tie(c.equilibrium, c.normal, c.friction) = std::tie(squares[0], squares[1], squares[2]);
  const Real violation = std::sqrt(c.equilibrium + c.normal + c.friction);
  const Scale scale = scale_of(problem, x, c.r, violation, rounding);
  c.scale = scale.size;
  c.attainable = rounding / c.scale;
  c.residual = std::max(violation, scale.unknown) / c.scale;
  for (Real* share : {&c.equilibrium, &c.normal, &c.friction}) *share = std::sqrt(*share) / c.scale;
  return c;
}

namespace {

/// The branch of one node; doubt, motion: gaps and forces, and displacements, that count as 0, over
/// the square root of the node's weight.
NodeState state_of(const ContactProblem& problem, Index i, const Vector& x, const Vector& r,
                   Real doubt, Real motion) {
  const Vector& w = problem.system->weight;
  const Index N = problem.system->first[i], t = problem.tangents(i);
  const NodeLaw law = law_of(problem.increment, i);
  const Real closing = problem.closing(i, x);
  if (!law.closed(closing, r[N]) && closing > doubt * std::sqrt(w[N])) return NodeState::separated;
  if (!law.has_friction()) return NodeState::slip;
  if (t == 0) return NodeState::stick;  // Dirichlet conditions hold its tangents
  const Real c_T = w[N + 1], g = law.limit(r[N]);
  const Real pressure = law.given ? 0 : std::abs(r[N]);
  const Real strength = std::max(law.open_limit(), pressure);
  const auto r_T = r.segment(N + 1, t), x_T = x.segment(N + 1, t);
  const bool forceless = law.coheres() || r_T.norm() <= doubt * std::sqrt(c_T);
  if (strength <= doubt * std::sqrt(w[N]) && forceless)
    return c_T * x_T.norm() <= motion * std::sqrt(c_T) ? NodeState::stick : NodeState::slip;
  return (r_T + c_T * x_T).norm() <= g ? NodeState::stick : NodeState::slip;
}

}  // namespace

std::vector<NodeState> classify(const ContactProblem& problem, const Vector& x,
                                const Certificate& c) {
  const Real doubt = std::min(std::max({grazing, c.residual, c.attainable}), vaguest);
  std::vector<NodeState> state(problem.nodes());
  for (Index i = 0; i < problem.nodes(); ++i)
    state[i] = state_of(problem, i, x, c.r, doubt * c.scale, still * c.scale);
  return state;
}

}  // namespace frictioncg
