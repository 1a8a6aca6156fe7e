#pragma once
#include "gradient/iterate.h"

namespace frictioncg {

/// Holds at x_T = 0 the nodes that have come to rest, in a step rho v: those that it turned round,
/// and those that move no more than the residual explains. One after the other, each where x_T = 0
/// minimizes J over its x_T while all others stay: J does not rise.
/// stiffness (m): of A_TT; residual: of the free dofs, in norm_D, roughly.
bool freeze_stick(Iterate& it, const Vector& v, Real rho, const Vector& stiffness, Real residual);

}  // namespace frictioncg
