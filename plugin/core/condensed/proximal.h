#pragma once
#include "condensed/attempt.h"

namespace frictioncg {

/// Proximal points (model/proximal_springs.h), where Newton's method alone does not arrive: from
/// x_0 = 0 by Newton's method with springs, until it arrives from x_k without them. At most
/// max_steps of Newton's method.
Attempt by_proximal_points(const CondensedProblem& problem, Index max_steps);

}  // namespace frictioncg
