#pragma once
#include "model/contact_problem.h"

namespace frictioncg {

/// A rigid motion (n) that no forces of contact and friction hold against the load: a proof that
/// there is no equilibrium. None where such forces exist, or neither is shown beyond rounding.
///
/// W: n x k, rigid motions (A W = 0). A motion w that is not quite one, as a soft deformation may
/// be, proves nothing where A w can carry what it claims: F.w = x'A w for a solution x of some
/// size.
///
/// Coulomb: are there forces r in the friction cones, r_N >= 0, |r_T| <= mu r_N at the nodes whose
/// gap is finite, with W'r = W'F? Where not, Farkas' lemma gives a motion w = W c with
///   F.w > 0  and  w_N + mu |w_T| <= 0  at these nodes,
/// and no method can find an equilibrium. It is what is left of the load after the nearest sum of
/// such forces. At given limits, r_N >= 0 and |r_T| <= g at every node:
///   F.w > sum_i g_i |w_T,i|  and  w_N <= 0,   along which J falls for ever.
/// Cohesion is such a bounded force at the nodes whose gap is finite; a cap leaves w_N <= 0 of the
/// cone, and a bounded force, too: the sum over the nodes of what friction can take at most is
///   c |w_T|  without a cap,  min(c, cap) |w_T|, or p w_N + cap |w_T| at the pressure p > 0 with
///   c + mu p = cap, whichever is more, with one.
/// Bilateral contact: r_N of either sign. Sums of such friction cones are a linear space, and the
/// test is made with that space: a motion stays a proof, where there is none nothing is shown.
std::optional<Vector> unheld_motion(const DenseMatrix& W, const ContactProblem& problem);

}  // namespace frictioncg
