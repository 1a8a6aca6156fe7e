#pragma once
#include "gradient/tresca.h"

namespace frictioncg {

/// Problem 1 (section 2), g = mu |F_N(u_g)| of (1): minimizations at given g, each started from the
/// last and no more precise than g is known; g accelerated. A given sliding limit takes one
/// minimization.
///
/// Status: converged where the certificate is within tol; fixed_point_diverged where the passes no
/// longer improve g, damped or not; regularized where eps is what keeps the certificate above tol;
/// stagnated where rounding is; else what ended the last minimization.
///
/// x0: n, or empty to start from sticking contact.
Solution fixed_point(const ContactProblem& problem, const Settings& settings, TrescaSolver& tresca,
                     const Vector& x0);

}  // namespace frictioncg
