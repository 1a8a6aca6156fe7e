#pragma once
// The judge of a solution: dense, in global components, straight from the script's data. It shares
// no code with the solver.
#include <algorithm>
#include <cmath>

#include "scene.h"

namespace frictioncg::test {

/// The largest violation of each law at a node, as a force over the largest force: contact laws
/// over the largest contact force (or a hundredth of the largest nodal load, where that is more),
/// equilibrium over the largest contact force or nodal load. A length counts as the force that it
/// takes at its node, and forces of soft and stiff nodes compare by what they do: both through k,
/// the mean diagonal of A at the node, as force/sqrt(k).
struct Verdict {
  double equilibrium = 0, penetration = 0, tension = 0, complementarity = 0, cone = 0, slip = 0;
  double worst() const {
    return std::max({equilibrium, penetration, tension, complementarity, cone, slip});
  }
};

/// Diagonal of A where a dof is free, 0 where Dirichlet conditions hold it.
Eigen::VectorXd free_diagonal(const Scene& s);

/// Violations of contact and friction at point p: u_N and F_N along its normal, and the rest.
void verify_point(const Scene& s, std::size_t p, const Vector& u, const Vector& force, double k,
                  double unit, Verdict& v);

Verdict verify(const Scene& s, const Vector& u, const Vector& force);

}  // namespace frictioncg::test
