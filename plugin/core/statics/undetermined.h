#pragma once
#include "solution.h"
#include "model/branch.h"

namespace frictioncg {

/// The rigid motions (span of W, n x k) that the branches of the contact nodes leave free: closed
/// nodes keep x_N, stuck nodes x_T, sliding nodes the direction of x_T.   n x (0 .. k)
DenseMatrix left_free(const DenseMatrix& W, const ContactProblem& problem,
                      const Branches& branches);

/// The branches that an answer is on. A node that touches without a force is open, and one that
/// sticks at its limit slips: neither resists going on that way. Shear alone, by cohesion, keeps
/// one closed.
Branches branches_of(const ContactProblem& problem, const Vector& x,
                     const Certificate& certificate);

/// Whether a node is closed without a force, or at rest at its limit: a method may have kept it so,
/// and what it alone held is free.
bool between_branches(const ContactProblem& problem, const Vector& x,
                      const Certificate& certificate, const Branches& branches);

/// The sliding limits of all nodes at an answer [force].   m
Vector limits_at(const ContactProblem& problem, const Solution& s);

/// The contact nodes of each body that contact pressed at the start of the increment, and that the
/// answer lets go: nothing of it sticks under a force any more, and its limits have fallen below
/// half of what they were, with the loads of the increment on its contact nodes. Under one load
/// contact may let go of a body and hold it, as a taper that locks itself. Of a system that one
/// process holds.
std::vector<std::vector<Index>> let_go(const ContactProblem& problem, const Solution& s);

/// Whether limits hold one of these bodies by more than twice what others do.
bool hold_more(const std::vector<std::vector<Index>>& bodies, const Vector& limits,
               const Vector& others);

/// Takes the undetermined motions of s out of s.x, as far as the laws allow it within tol: gaps
/// stay open or close, and slip goes on; within rounding, where s.x is beyond tol. x is then the
/// least that differs from it by them, in the product of D.
void leave_least(const ContactProblem& problem, Real tol, Solution& s);

/// Takes off a load F what works on motions that no normal resists, where that is no more than
/// `told` of what the load could work on them at most. Where the mesh tells the normals, it tells
/// the axis of such motions up to their errors, and a load straight along the axis of a seat turns
/// about the one that is told. Of motions that some process owns.
///
///   F <- F - D Z (Z'DZ)^{-1} Z'F,   Z of W (n x k) with Z_N = 0,   |Z'F| <= told |F|_1 max |Z|
///
/// Returns |Z'F| over what it could be, and 0 where nothing is taken off.
Real leave_out_uncertain_work(const System& system, const DenseMatrix& W, Real told, Vector& F);

}  // namespace frictioncg
