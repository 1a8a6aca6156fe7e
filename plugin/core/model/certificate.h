#pragma once
#include "model/law.h"

namespace frictioncg {

/// How far x is from the unregularized laws of contact and friction, whatever method found it.
///
///   r = F - Ax                                     interior: r = 0
///   normal:    min(A_NN (gap - x_N), r_N) = 0      r_N >= 0 presses on the obstacle
///              bilateral: A_NN (gap - x_N) = 0
///   friction:  r_T - proj_{|.| <= g}(r_T + A_TT x_T) = 0
///              g = mu max(r_N, 0), bilateral mu |r_N|, or given
///
/// residual = norm of the three, each scaled by weight^{-1/2}, over the scale: dimensionless,
/// invariant under a change of units and under rotation.
struct Certificate {
  Real residual = 0;
  Real equilibrium = 0;  ///< its share from the interior dofs
  Real normal = 0;       ///< its share from unilateral contact
  Real friction = 0;     ///< its share from friction
  Real scale = 1;        ///< what the residual is measured in, > 0 [force/stiffness^(1/2)]
  Vector r;              ///< n, F - Ax: minus the force of the obstacle on the body [force]
};

enum class NodeState : Index { none = 0, separated = 1, slip = 2, stick = 3 };

Certificate certify(const ContactProblem& problem, const Vector& x);

/// Which branch of the laws each contact node is on (m); the certificate is that of x.
std::vector<NodeState> classify(const ContactProblem& problem, const Vector& x,
                                const Certificate& certificate);

}  // namespace frictioncg
