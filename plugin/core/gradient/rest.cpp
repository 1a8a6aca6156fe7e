#include "gradient/rest.h"

#include <cmath>
#include <cstdlib>

#include "model/law.h"

namespace frictioncg {

namespace {

/// A slip that changes the residual by less than this share of it cannot be told from rest. From
/// 0.01 to 10 the iterations are the same: it matters where a node creeps to 0 without turning.
constexpr Real creep = 0.1;
constexpr Real rounding = 1e-12;  ///< of the cosine between x_T and v_T

/// Came nearer to x_T = 0 along the step, and is closest to it, or past it.
bool turned(const Tangent& x_T, const Tangent& v_T, Real rho) {
  const Real now = x_T.dot(v_T), before = now - rho * v_T.squaredNorm();
  return before < 0 && now >= -rounding * x_T.norm() * v_T.norm();
}

}  // namespace

bool freeze_stick(Iterate& it, const Vector& v, Real rho, const Vector& stiffness, Real residual) {
  bool frozen = false;
  for (Index i = 0; i < it.system.nodes(); ++i) {
    const Index T = it.system.first[i] + 1, c = T - it.system.interior(), t = it.system.tangents(i);
    if (t == 0 || it.faces.at_rest(i) || it.g[i] == 0) continue;
    const Tangent x_T = it.x.segment(T, t);
    const bool creeps = std::sqrt(stiffness[i]) * x_T.norm() <= creep * residual;
    if (!creeps && !turned(x_T, v.segment(T, t), rho)) continue;
    const Tangent y = it.rows.r().segment(c, t) + stiffness[i] * x_T;
    static const bool relax = getenv("RELAX");
    if (y.norm() > it.g[i]) {
      if (!relax || creeps) continue;
      const Tangent to = (1 - it.g[i] / y.norm()) / stiffness[i] * y;
      for (Index k = 0; k < t; ++k) it.rows.displace(it.x, c + k, to[k] - x_T[k]);
      frozen = true;
      continue;
    }
    for (Index k = 0; k < t; ++k) it.rows.displace(it.x, c + k, -x_T[k]);
    it.x.segment(T, t).setZero();
    it.faces.activate_stick(i);
    frozen = true;
  }
  return frozen;
}

}  // namespace frictioncg
