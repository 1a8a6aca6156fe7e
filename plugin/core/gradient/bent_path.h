#pragma once
#include "gradient/iterate.h"
#include "gradient/line_search.h"

namespace frictioncg {

/// The projected path beyond the first gap: the direction v, less the normals of the nodes that
/// have reached their gap, from gap to gap, each piece to the minimum of J along it. J never rises.
///
/// Only the contact dofs see the bends, so that all pieces together cost their rows; the interior
/// moves by the same v throughout, once.
///
/// it.x has just moved by rho v, line.a and line.vAv are those of v before that step, and it.faces
/// holds the nodes that reached their gap in it. Moves the contact dofs further, and the interior
/// through P. Returns the length that rho gains; 0 where J does not fall beyond.
Real follow_bent_path(Iterate& it, Preconditioner& P, LineSearch& search, const Vector& v, Real rho,
                      Line line);

}  // namespace frictioncg
