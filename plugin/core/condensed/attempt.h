#pragma once
#include "condensed/semismooth_newton.h"
#include "status.h"

namespace frictioncg {

/// How an attempt at the laws on the contact dofs ended.
struct Attempt {
  Vector x;           ///< contact_dofs; empty where nothing was found
  Branches branches;  ///< of x, where Newton's method found it
  bool solved = false;
  bool undetermined = false;  ///< a motion is free, and x has the least
  bool positive = false;      ///< S is known to be positive definite on open nodes
  Index steps = 0;            ///< of Newton's method, solved or not
  Status status = Status::stagnated;
};

/// Newton's method from the branches of x, or where x is empty from given ones, or where these are
/// from stick: the rest of max_steps, at most 40. True where it arrives; a is then its answer, and
/// else keeps the one it has.
bool newton_from(const Vector& x, const CondensedProblem& problem, Index max_steps, Attempt& a,
                 const Branches& given = {});

/// Proximal points (model/proximal_springs.h), where Newton's method alone does not arrive: from
/// x_0 = 0 by Newton's method with springs, until it arrives from x_k without them. At most
/// max_steps of Newton's method.
Attempt by_proximal_points(const CondensedProblem& problem, Index max_steps);

}  // namespace frictioncg
