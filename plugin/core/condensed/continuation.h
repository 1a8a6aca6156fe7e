#pragma once
#include "condensed/attempt.h"

namespace frictioncg {

/// Friction coefficients from 0 up to their values, each solution the start of the next; the step
/// adapts. Nothing to do for other laws. At most max_steps of Newton's method.
Attempt by_continuation(const CondensedProblem& problem, Index max_steps);

}  // namespace frictioncg
