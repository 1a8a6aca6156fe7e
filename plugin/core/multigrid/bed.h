#pragma once
#include "model/branch.h"
#include "model/contact_problem.h"

namespace frictioncg {

/// The faces where Newton's method starts: stick (all_stick), and open where free obstacles do not
/// reach under their loads f, if each contact node i has a spring k_i of its own for a body:
///
///   min_q  1/2 sum_closed k_i (|(C_i q)_N - gap_i|^2 + |(C_i q)_T|^2) - f'q,
///   closed: (C_i q)_N >= gap_i
///
/// C being the border. From stick everywhere a sphere sticks to what it does not touch, and lets
/// go of it step by step. Stick, too, where the closed nodes could not hold f.
Branches reached(const ContactProblem& problem);

}  // namespace frictioncg
