#pragma once
#include "condensed/semismooth_newton.h"

namespace frictioncg {

/// True where contact and Coulomb friction cannot hold the load, whatever the method: there is a
/// rigid motion w (S w = 0) on which the load works, f.w > 0, and no force of a friction cone
/// resists,
///   w_N + mu |w_T| <= 0 at every node.
/// By Farkas' lemma it is what is left of the load on the rigid motions after the nearest sum of
/// forces from the cones. (At a given limit g the minimization itself sees J fall for ever.)
bool cannot_be_held(const CondensedProblem& condensed);

}  // namespace frictioncg
