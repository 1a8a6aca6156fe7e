#pragma once
#include "condensed/semismooth_newton.h"

namespace frictioncg {

/// How an attempt at the laws on the contact dofs ended.
struct Attempt {
  Vector x;  ///< contact_dofs
  std::vector<SemismoothNewton::Branch> branches;
  bool solved = false;
  bool undetermined = false;  ///< a motion is free, and x has the least
  Index steps = 0;            ///< of Newton's method
};

/// Proximal points, where Newton's method alone does not arrive: springs eps D on the contact dofs
/// whose other ends follow,
///   (S + eps D) x_k = f + eps D x_{k-1} - r,  x_0 = 0,
/// until Newton's method arrives from x_k without them. For eps > 0 the matrix is definite,
/// whatever motions contact leaves free: the body creeps to where contact and friction hold it. eps
/// falls where a point is found, and rises where not.
Attempt by_proximal_points(const CondensedProblem& problem, Index max_steps);

/// Friction coefficients from 0 up to their values, each solution the start of the next; the step
/// adapts. Nothing to do for other laws.
Attempt by_growing_friction(const CondensedProblem& problem, Index max_steps);

}  // namespace frictioncg
