#pragma once
#include "condensed/condensed_problem.h"
#include "solution.h"

namespace frictioncg {

/// The paper's method on S: GC3 and the fixed point, regularized. start: contact_dofs, or empty.
/// The solution's fields are those of the contact dofs; settings.nbiter > 0 bounds its iterations.
Solution by_regularization(const CondensedProblem& problem, const Settings& settings,
                           const Vector& start);

}  // namespace frictioncg
