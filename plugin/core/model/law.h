#pragma once
#include "model/contact_problem.h"

namespace frictioncg {

/// The tangential components of a node: at most two, never allocated.
using Tangent = Eigen::Matrix<Real, Eigen::Dynamic, 1, 0, 2, 1>;

/// The laws of contact and friction at one node, as equations whose residuals vanish. r is the
/// force of the body on the obstacle, k > 0 any stiffness [force/length], closing = k (gap - x_N):
///   normal:    min(closing, r_N) = 0;  bilateral: closing = 0
///   friction:  r_T - proj_{|.| <= g}(r_T + k x_T) = 0
///   g = min(l c + mu r_N, cap),  l in H(r_N - closing);  bilateral: min(c + mu |r_N|, cap)
/// H is Heaviside's function with its jump filled: a closed node has l = 1, an open one 0 and with
/// it no shear; one that touches without a force, closing = r_N = 0, has any part of its cohesion,
/// else the laws of nodes that are about to open would have no answer. A given limit is a c that
/// open nodes keep.
struct NodeLaw {
  Real mu = 0;          ///< [1]
  Real c = 0;           ///< cohesion, or given limit [force]
  Real cap = infinity;  ///< [force]
  bool bilateral = false;
  bool given = false;  ///< c is a given limit, which acts on open nodes, too

  /// Sliding limit [force] of a node that is closed.
  Real limit(Real r_N) const { return std::min(uncapped(r_N), cap); }
  bool capped(Real r_N) const { return uncapped(r_N) > cap; }
  Real open_limit() const { return given ? c : 0; }  ///< [force]

  /// closing = k (gap - x_N) [force].
  Real normal_residual(Real closing, Real r_N) const {
    return bilateral ? closing : std::min(closing, r_N);
  }

  /// The branch of the normal law: x_N = gap in place of r_N = 0.
  bool closed(Real closing, Real r_N) const { return bilateral || r_N > closing; }

  /// Sliding limit g [force]: a node that is open has no pressure, whatever rounding leaves of it.
  Real limit(Real closing, Real r_N) const {
    return closed(closing, r_N) ? limit(r_N) : open_limit();
  }

  bool has_friction() const { return (mu > 0 || c > 0) && cap > 0; }
  /// The limit jumps where the node opens.
  bool coheres() const { return c > 0 && cap > 0 && !given && !bilateral; }

 private:
  Real uncapped(Real r_N) const {
    return c + mu * (bilateral ? std::abs(r_N) : std::max(r_N, 0.0));
  }
};

inline NodeLaw given_limit(Real g, bool bilateral) { return {0, g, infinity, bilateral, true}; }

NodeLaw law_of(const Increment& increment, Index i);

/// r_T - proj_{|.| <= g}(r_T + c x_T): c x_T (up to the sign) where it sticks, what r_T misses of
/// the limit, and of its direction, where it slips.
Tangent friction_residual(const Tangent& r_T, const Tangent& x_T, Real c, Real g);

/// Squares, in norm_D, of what (x, r) miss of the laws at one node.
struct Violation {
  Real normal = 0, friction = 0;
};

/// w, x, r: of the normal of the node, then of its tangents; w as System::weight, which is c.
Violation violation(const NodeLaw& law, Real gap, const Eigen::Ref<const Vector>& w,
                    const Eigen::Ref<const Vector>& x, const Eigen::Ref<const Vector>& r);

/// Their sums over the contact nodes of this process. w, x, r: of all dofs, or of the last ones.
Violation violation(const ContactProblem& problem, const Vector& w, const Vector& x,
                    const Vector& r);

}  // namespace frictioncg
