#pragma once
#include "condensed/attempt.h"

namespace frictioncg {

/// Proximal points, where Newton's method alone does not arrive: springs eps D on the contact dofs
/// whose other ends follow,
///   (S + eps D) x_k = f + eps D x_{k-1} - r,  x_0 = 0,
/// until Newton's method arrives from x_k without them. For eps > 0 the matrix is definite,
/// whatever motions contact leaves free: the body creeps to where contact and friction hold it. eps
/// falls where a point is found, and rises where not. At most max_steps of Newton's method.
Attempt by_proximal_points(const CondensedProblem& problem, Index max_steps);

}  // namespace frictioncg
