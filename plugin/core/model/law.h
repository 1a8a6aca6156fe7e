#pragma once
#include <algorithm>
#include <cmath>

#include "model/contact_problem.h"

namespace frictioncg {

/// The tangential components of a node: at most two, never allocated.
using Tangent = Eigen::Matrix<Real, Eigen::Dynamic, 1, 0, 2, 1>;

/// The laws of contact and friction at one node, as equations whose residuals vanish. r is the
/// force of the body on the obstacle, c > 0 any stiffness [force/length]:
///   normal:    min(c (gap - x_N), r_N) = 0;  bilateral: c (gap - x_N) = 0
///   friction:  r_T - proj_{|.| <= g}(r_T + c x_T) = 0
///   g = given limit + mu max(r_N, 0);  bilateral: mu |r_N|;  open: the given limit alone
struct NodeLaw {
  Real mu = 0;  ///< [1]
  Real g = 0;   ///< given limit [force]
  bool bilateral = false;

  /// Sliding limit g + mu r_N [force] of a node that is closed.
  Real limit(Real r_N) const { return g + mu * (bilateral ? std::abs(r_N) : std::max(r_N, 0.0)); }

  /// closing = c (gap - x_N) [force].
  Real normal_residual(Real closing, Real r_N) const {
    return bilateral ? closing : std::min(closing, r_N);
  }

  /// The branch of the normal law: x_N = gap in place of r_N = 0.
  bool closed(Real closing, Real r_N) const { return bilateral || r_N > closing; }

  /// Sliding limit g [force]: a node that is open has no pressure, whatever rounding leaves of it.
  Real limit(Real closing, Real r_N) const { return limit(closed(closing, r_N) ? r_N : 0); }

  bool has_friction() const { return mu > 0 || g > 0; }
};

inline NodeLaw law_of(const Increment& increment, Index i) {
  const bool rubs = increment.law != Law::frictionless;
  return {increment.law == Law::coulomb ? increment.mu[i] : 0,
          rubs && increment.g.size() > 0 ? increment.g[i] : 0, increment.bilateral};
}

/// r_T - proj_{|.| <= g}(r_T + c x_T): c x_T (up to the sign) where it sticks, what r_T misses of
/// the limit, and of its direction, where it slips.
inline Tangent friction_residual(const Tangent& r_T, const Tangent& x_T, Real c, Real g) {
  const Tangent y = r_T + c * x_T;
  const Real norm = y.norm();
  if (norm <= g) return -c * x_T;  // not r_T - y: rounding of r_T would drown a small x_T
  return r_T - (g / norm) * y;
}

/// Squares, in norm_D, of what (x, r) miss of the laws at one node.
struct Violation {
  Real normal = 0, friction = 0;
};

/// w, x, r: of the normal of the node, then of its tangents; w as System::weight, which is c.
inline Violation violation(const NodeLaw& law, Real gap, const Eigen::Ref<const Vector>& w,
                           const Eigen::Ref<const Vector>& x, const Eigen::Ref<const Vector>& r) {
  const Real closing = w[0] * (gap - x[0]), normal = law.normal_residual(closing, r[0]);
  Violation v{normal * normal / w[0], 0};
  const Index t = static_cast<Index>(w.size()) - 1;
  if (t == 0) return v;
  const Tangent friction = friction_residual(r.tail(t), x.tail(t), w[1], law.limit(closing, r[0]));
  v.friction = friction.squaredNorm() / w[1];
  return v;
}

}  // namespace frictioncg
