#pragma once
#include "condensed/semismooth_newton.h"

namespace frictioncg {

/// The fixed point on the sliding limit (section 2), where Newton's method on the laws does not
/// arrive: nearly incompressible bodies with much friction. Problem 2 has one answer at each limit,
/// which the central path finds, and Newton's method from the last one; after some limits it is
/// tried on the full laws again. Under Coulomb's law; else nothing is tried.
Attempt by_limits(const CondensedProblem& problem, const Settings& settings);

/// The paper's method on S: GC3 and the fixed point, regularized. start: contact_dofs, or empty.
/// The solution's fields are those of the contact dofs; settings.nbiter > 0 bounds its iterations.
Solution by_regularization(const CondensedProblem& problem, const Settings& settings,
                           const Vector& start);

}  // namespace frictioncg
