#pragma once
#include "solution.h"
#include "statics/floating.h"

namespace frictioncg {

/// J without a bound at the present sliding limit says nothing about Coulomb's law, and a stall
/// nothing about the load. Rigid motions do: no_equilibrium where one of them is a proof, and
/// nowhere else.
void decide_on_equilibrium(const ContactProblem& problem, FloatingMotions& floating, Solution& s);

/// The paper's methods as a route: the fixed point on the sliding limit, and at each limit the
/// method of the settings. floating: the motions of the system.
Solution by_gradients(const Request& request, FloatingMotions& floating);

}  // namespace frictioncg
