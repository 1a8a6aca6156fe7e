#pragma once
#include <vector>

#include "domain.h"

namespace frictioncg {

/// What hangs together on several processes, from the parts of each that hang together: those with
/// a dof in common are one whole.
struct Wholes {
  std::vector<Index> of_part;  ///< of each part here
  Index count = 0;             ///< on all processes
};

/// A dof of the domain that one of the parts here has.
struct DofOfPart {
  Index dof, part;
};

/// parts: how many there are here.   Collective.
Wholes join_parts(const Domain& domain, const std::vector<DofOfPart>& dofs, Index parts);

}  // namespace frictioncg
