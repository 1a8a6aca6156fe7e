#pragma once
#include "model/law.h"

namespace frictioncg {

/// How far x is from the unregularized laws of contact and friction, whatever method found it.
///
///   r = F - Ax                                     interior: r = 0
///   normal:    min(c_N (gap - x_N), r_N) = 0       r_N >= 0 presses on the obstacle
///              bilateral: c_N (gap - x_N) = 0
///   friction:  r_T - proj_{|.| <= g}(r_T + c_T x_T) = 0
///              g = min(c + mu r_N, cap) where closed, 0 where open, between where it touches
///              without a force; bilateral min(c + mu |r_N|, cap); or given
///   c = weight
///
/// residual = norm of the three, in norm_D, over the scale: dimensionless, invariant under a change
/// of units and under rotation.
///
/// The scale is what is at work: the forces of the closed contact nodes, together with a hundredth
/// of the load, both as they are in the total state, so that neither Dirichlet data that only move
/// the body, nor the increments that led there, count. Where neither is there beyond rounding, it
/// is the force that would close the nearest gap, so that what is called open is open; and where
/// all is rounding, what drives the increment: |F|, |Ax|, or the force that closes the initial
/// penetration.
struct Certificate {
  Real residual = 0;
  Real equilibrium = 0;  ///< its share from the interior dofs
  Real normal = 0;       ///< its share from unilateral contact
  Real friction = 0;     ///< its share from friction
  Real scale = 1;        ///< what the residual is measured in, > 0, in norm_D
  Real attainable = 0;   ///< the residual that rounding of Ax and F leaves, about
  Vector r;              ///< n, F - Ax: minus the force of the obstacle on the body [force]
};

/// Whether the residual may be the work of rounding alone.
bool may_be_rounding(const Certificate& certificate);

/// The forces at work, in norm_D, of an external load and of the contact forces of closed nodes.
Real forces_at_work(Real load, Real contact);

enum class NodeState : Index { none = 0, separated = 1, slip = 2, stick = 3 };

Certificate certify(const ContactProblem& problem, const Vector& x);

/// Which branch of the laws each contact node is on (m); the certificate is that of x. A node whose
/// limit is 0 slides. A node that touches without a force, as the vertices of P2 do under a uniform
/// pressure in 3D, follows its neighbours: its law says nothing, its displacement does. So it is
/// with one that touches by its cohesion alone.
std::vector<NodeState> classify(const ContactProblem& problem, const Vector& x,
                                const Certificate& certificate);

}  // namespace frictioncg
