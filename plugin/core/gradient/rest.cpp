#include "gradient/rest.h"

#include <cmath>

#include "model/law.h"

namespace frictioncg {

namespace {

/// A slip that changes the residual by less than this share of it cannot be told from rest. From
/// 0.01 to 10 the iterations are the same: it matters where a node creeps to 0 without turning.
constexpr Real creep = 0.1;
/// The cosine between x_T and v_T is known up to this: a node at its closest to 0 has turned.
constexpr Real rounding = 1e-12;

/// Came nearer to x_T = 0 along the step, and is closest to it, or past it.
bool turned(const Tangent& x_T, const Tangent& v_T, Real rho) {
  const Real now = x_T.dot(v_T), before = now - rho * v_T.squaredNorm();
  return before < 0 && now >= -rounding * x_T.norm() * v_T.norm();
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
