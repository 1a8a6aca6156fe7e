#include "gradient/release_rule.h"

#include "model/law.h"

namespace frictioncg {

ReleaseRule::ReleaseRule(const Settings& settings, const System& system)
    : at_once_(settings.method == Method::gc1 || settings.method == Method::gc2),
      restarts_(settings.method != Method::gc2),
      stick_is_a_face_(settings.method == Method::gcx),
      partial_(settings.partial),
      d_(stick_is_a_face_ ? system.contact_dofs() : 0) {}

Real ReleaseRule::threshold(Real eps_0, Real violation) const {
  if (at_once_) return 0;
  return stick_is_a_face_ ? violation : partial_ * eps_0;
}

bool ReleaseRule::release(Iterate& it, Real least) {
  return stick_is_a_face_ ? release_by_step(it, least) : it.faces.open_tensile(it.rows.r(), least);
}

bool ReleaseRule::release_by_step(Iterate& it, Real least) {
  const Real beta_d = descent(it, least);
  if (beta_d == 0) return false;
  const Real rho = beta_d / it.rows.energy(d_);
  for (Index i = 0; i < it.system.nodes(); ++i) {
    const Index c = it.system.first[i] - it.system.interior(), t = it.system.tangents(i);
    if (d_[c] != 0) it.faces.open_contact(i);
    if (!d_.segment(c + 1, t).isZero(0)) it.faces.open_stick(i);
    for (Index k = c; k <= c + t; ++k)
      if (d_[k] != 0) it.rows.displace(it.x, k, rho * d_[k]);
  }
  return true;
}

/// d := W^{-1} beta, W the weights; returns <beta, d>.
Real ReleaseRule::descent(const Iterate& it, Real least) {
  const Vector &r = it.rows.r(), &w = it.system.weight;
  Real beta_d = 0;
  d_.setZero();
  for (Index i = 0; i < it.system.nodes(); ++i) {
    const Index N = it.system.first[i], c = N - it.system.interior(), t = it.system.tangents(i);
    const Real tension = it.faces.tension(i, r);
    if (tension > least * std::sqrt(w[N])) {
      d_[c] = -tension / w[N];
      beta_d += tension * tension / w[N];
    }
    const Real excess = it.faces.stick_excess(i, r, it.g);
    if (excess == 0 || excess <= least * std::sqrt(w[N + 1])) continue;
    const auto r_T = r.segment(c + 1, t);
    d_.segment(c + 1, t) = (excess / r_T.norm() / w[N + 1]) * r_T;
    beta_d += excess * excess / w[N + 1];
  }
  return beta_d;
}

namespace {

/// A slip that changes the residual by less than this share of it cannot be told from rest. From
/// 0.01 to 10 the iterations are the same: it matters where a node creeps to 0 without turning.
constexpr Real creep = 0.1;
/// The cosine between x_T and v_T is known up to this: a node at its closest to 0 has turned.
constexpr Real known_cosine = 1e-12;

/// Came nearer to x_T = 0 along the step, and is closest to it, or past it.
bool turned(const Tangent& x_T, const Tangent& v_T, Real rho) {
  const Real now = x_T.dot(v_T), before = now - rho * v_T.squaredNorm();
  return before < 0 && now >= -known_cosine * x_T.norm() * v_T.norm();
}

}  // namespace

bool come_to_rest(Iterate& it, const Vector& v, Real rho, const Vector& stiffness, Real residual) {
  bool moved = false;
  for (Index i = 0; i < it.system.nodes(); ++i) {
    const Index T = it.system.first[i] + 1, c = T - it.system.interior(), t = it.system.tangents(i);
    if (t == 0 || it.faces.at_rest(i) || it.g[i] == 0) continue;
    const Tangent x_T = it.x.segment(T, t);
    const bool turns = turned(x_T, v.segment(T, t), rho);
    const bool creeps = std::sqrt(stiffness[i]) * x_T.norm() <= creep * residual;
    if (!turns && !creeps) continue;
    const Tangent y = it.rows.r().segment(c, t) + stiffness[i] * x_T;
    const bool rests = y.norm() <= it.g[i];
    if (!rests && !turns) continue;
    const Real share = rests ? 0 : (1 - it.g[i] / y.norm()) / stiffness[i];
    for (Index k = 0; k < t; ++k) it.rows.displace(it.x, c + k, share * y[k] - x_T[k]);
    if (rests) it.x.segment(T, t).setZero();
    if (rests) it.faces.activate_stick(i);
    moved = true;
  }
  return moved;
}

}  // namespace frictioncg
