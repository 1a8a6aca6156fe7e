#include "gradient/gcx.h"

#include <cmath>

namespace frictioncg {

bool Gcx::release(Iterate& it, Real least) {
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
Real Gcx::descent(const Iterate& it, Real least) {
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

}  // namespace frictioncg
