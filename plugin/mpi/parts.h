#pragma once
#include "domain.h"
#include "model/system.h"

namespace frictioncg {

/// What hangs together on several processes, from the parts of each that hang together: those with
/// a dof in common are one whole. parts.of: of some dofs of the domain, the part here that each
/// belongs to, and their wholes in what is returned.   Collective.
Bodies join_parts(const Domain& domain, const std::vector<Index>& dofs, const Bodies& parts);

}  // namespace frictioncg
