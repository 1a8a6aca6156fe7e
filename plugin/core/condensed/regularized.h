#pragma once
#include "condensed/condensed_problem.h"
#include "solution.h"

namespace frictioncg {

/// The paper's method on S: GC3 and the fixed point, regularized. start: contact_dofs, or empty.
/// The solution's fields are those of the contact dofs; at most max_iterations.
Solution by_regularization(const CondensedProblem& problem, const Settings& settings,
                           Index max_iterations, const Vector& start);

}  // namespace frictioncg
