#pragma once
#include "freefem.h"

#include "../core/gradient/anderson.h"
#include "scene.h"

namespace frictioncg {

/// Values at the nodes of the faces.
using AtNodes = std::vector<mortar::Vec3>;

/// A step of Newton's method for bodies whose geometry is that of U. What is solved with A less the
/// symmetric stiffness S of the contact forces G'y, and with the gaps g of U, lacks to first order
/// in v = u - U
///
///   (A - S) u = b - S U + N v + G'y,     N = d(G'y)/dU - S
///   n.G u <= g + n.G U + R v,            R = dg/dU + n.G
///
/// which is added pass by pass, with the v that the passes before lead to: other loads and other
/// gaps for the factors at hand. The answer is certified on the laws of its pass; where u = U they
/// are those of the geometry at u. Far away from there passes that do not contract are not taken.
///
/// N and R ask for v at the nodes of the faces alone, and so does all that is decided here: several
/// processes, which have the faces whole, decide alike.
///
/// s: the answer without v; trace(s): an answer's u at the nodes, as U has them; pass(v, x0): the
/// answer with v at the nodes, begun from x0.
template <class Trace, class Pass>
Solution newton_step(Solution s, const AtNodes& U, const Trace& trace, const Pass& pass) {
  constexpr int passes = 5;
  constexpr Real precise = 1e-3;      // over the step: the next one is what it is squared
  constexpr Real negligible = 1e-10;  // over the displacement
  constexpr Real contraction = 0.6;   // over the step: beyond, slopes at U say too little
  const auto stacked = [](const AtNodes& u) {
    return Vector(Eigen::Map<const Vector>(u.front().data(), 3 * static_cast<Index>(u.size())));
  };
  const Vector at = stacked(U);
  Vector u = stacked(trace(s));
  Real last = (u - at).lpNorm<Eigen::Infinity>();
  const Real enough = std::max(precise * last, negligible * u.lpNorm<Eigen::Infinity>());
  const Real far = contraction * last;
  Anderson anderson;
  u = anderson.next(at, u);
  AtNodes v(U.size());
  for (int k = 0; k < passes && last > enough; ++k) {
    Eigen::Map<Vector>(v.front().data(), u.size()) = u - at;
    Solution next = pass(v, s.x);
    if (next.status != Status::converged) break;
    const Vector now = stacked(trace(next));
    const Real change = (now - u).lpNorm<Eigen::Infinity>();
    if (change > std::min(far, last)) break;
    next.iterations += s.iterations;
    s = std::move(next);
    u = anderson.next(u, now);
    last = change;
  }
  return s;
}

/// The same in one process. b, u_old: by all dofs; u0: where the increment of s starts. A gap that
/// is given stays as it is.
inline Solution newton_step(Solution s, const Vector& u0, const Settings& settings,
                            const Scene& scene, const Vector& b, const Vector& u_old,
                            const PointLaws& laws) {
  if (scene.system->nodes() == 0) return s;
  const Pairing& pairing = *scene.pairing;
  const Vector slip_from = scene.slip_from(u_old);
  const auto trace = [&](const Solution& of) {
    return pairing.at_nodes(scene.system->to_global(of.x, u0), scene.d);
  };
  const auto pass = [&](const AtNodes& v, const Vector& x0) {
    const mortar::Change change = pairing.change(v, scene.d);
    PointLaws of_pass = laws;
    if (!laws.given_gap) of_pass.gap.head(change.gap.size()) += change.gap;
    const Vector rest = b + pairing.on_free_dofs(change.force, b.size(), scene.d) -
                        scene.stiffened->force(pairing.on_free_dofs(v, b.size(), scene.d));
    const LocalLoad load = scene.system->load_from(rest, slip_from);
    return scene.solver->solve(scene.increment(load, of_pass).increment, settings, x0);
  };
  return newton_step(std::move(s), pairing.at_nodes(*scene.at, scene.d), trace, pass);
}

}  // namespace frictioncg
