#pragma once
#include "semismooth_newton.h"

namespace frictioncg {

/// A certificate that contact and friction cannot hold the load: a rigid motion w (S w = 0) on
/// which the load works and the obstacle cannot answer.
///   Coulomb: f.w > 0 with w_N + mu |w_T| <= 0 at every node: no force of the friction cone resists
///   given g: f.w > sum_i g_i |w_T,i| with w_N <= 0
/// True where one is found; then there is no equilibrium, whatever the method. w may be empty.
bool cannot_be_held(const CondensedProblem& condensed);

}  // namespace frictioncg
