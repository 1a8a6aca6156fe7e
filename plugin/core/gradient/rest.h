#pragma once
#include "gradient/iterate.h"

namespace frictioncg {

/// Where stick is a face: what becomes of the nodes that a step rho v has turned round, and of
/// those that move no more than the residual explains. One after the other, while all others stay,
/// each goes to the minimum over its x_T of
///   J with A_TT replaced by stiffness I >= A_TT:   x_T := (1 - g/|y|)_+ y/stiffness,
///                                                  y = (F - Ax)_T + stiffness x_T,
/// so that J never rises. A node whose minimum is x_T = 0 is held there from here on; one that only
/// creeps stays where its minimum is elsewhere. True if a node has moved.
/// stiffness (m): of A_TT; residual: of the free dofs, in norm_D, roughly.
bool come_to_rest(Iterate& it, const Vector& v, Real rho, const Vector& stiffness, Real residual);

}  // namespace frictioncg
