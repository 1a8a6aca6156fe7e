#pragma once
#include "condensed/condensed_problem.h"
#include "statics/equilibrium.h"

namespace frictioncg {

/// Bilateral contact with Coulomb friction: normal forces of either sign need no load, so that
/// rigid motions alone hold anything by friction; the stiffness of the body bounds these forces.
/// With x_N = gap, and x_T up to the rigid motions along the obstacle,
///   r_N = N0 + H r_T,  |r_T| <= c + mu |r_N|,  so that  |r_N| <= p,  p = |N0| + |H| (c + mu p),
/// if there is such a p >= 0. Whatever holds then holds at the given limits min(c + mu p, cap).
///
/// W: n x k, rigid motions (A W = 0). A motion is a proof as unheld_motion() gives it.
std::optional<Vector> unheld_at_bounded_pressure(const DenseMatrix& W,
                                                 const CondensedProblem& problem);

}  // namespace frictioncg
