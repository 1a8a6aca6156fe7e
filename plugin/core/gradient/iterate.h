#pragma once
#include "gradient/active_set.h"
#include "gradient/contact_rows.h"

namespace frictioncg {

/// Where a minimization stands.
struct Iterate {
  explicit Iterate(const ContactProblem& problem)
      : system(*problem.system), rows(problem), faces(problem) {}

  const System& system;
  Vector x;          ///< n
  Vector g;          ///< m, the sliding limit
  ContactRows rows;  ///< F - Ax on the contact dofs
  ActiveSet faces;   ///< that x lies on
};

}  // namespace frictioncg
