#pragma once
#include "solution.h"
#include "model/branch.h"

namespace frictioncg {

/// The rigid motions (span of W, n x k) that the branches of the contact nodes leave free: closed
/// nodes keep x_N, stuck nodes x_T, sliding nodes the direction of x_T.   n x (0 .. k)
DenseMatrix left_free(const DenseMatrix& W, const ContactProblem& problem,
                      const Branches& branches);

/// The branches that an answer is on. A node that touches without a force is open: nothing keeps it
/// there. Shear alone, by cohesion, does.
Branches branches_of(const ContactProblem& problem, const Vector& x,
                     const Certificate& certificate);

/// Whether a node is closed without a force: a method may have kept it so, and what it alone held
/// is free.
bool touches_without_force(const ContactProblem& problem, const Vector& x,
                           const Certificate& certificate);

/// Takes the undetermined motions of s out of s.x, as far as the laws allow it within tol: gaps
/// stay open or close, and slip goes on.
void leave_least(const ContactProblem& problem, Real tol, Solution& s);

/// x (n) less its part along the motions (n x k), in the product of D: the least that differs from
/// x by them.
Vector least(const Vector& x, const DenseMatrix& motions, const System& system);

}  // namespace frictioncg
