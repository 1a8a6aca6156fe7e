#pragma once
#include "model/system.h"

namespace frictioncg {

/// A W (n x k), W the rigid motions of each body, where A resists them nearly everywhere: inertia,
/// as in a time step, or an elastic foundation. Empty where supports alone do, or nothing does.
Matrix inertia_of(const System& system);

/// min over c of |b - A W c| in norm_D: what an external load b does beside moving bodies as a
/// whole. A time step has in b what carries the bodies on, which grows with how far and how fast
/// they go, and of which contact forces and laws know nothing. |b| where there is no inertia.
Real load_beside_inertia(const System& system, const Vector& b);

}  // namespace frictioncg
