#pragma once
#include "assembly/mortar/mortar.h"

namespace frictioncg::mortar {

/// A weight changes by no more than this share of it. Fits change by 1e-2 and less; what asks for
/// more lies further away than a facet is long, and gets a part.
constexpr Real most_change = 0.3;
/// What is singular in M: in 2D its rank is 1, in 3D it is 2.
constexpr Real singular = 1e-6;

/// P with rows whose normal forces have no moment. Forces G'y along n_i act on the slave at X_i and
/// on the master in the mean at sum_l P_il X_l, where the normals of the slave's facets lead; on
/// curved faces that point lies beside the normal n_i by
///
///   e = (1 - n n') sum_l G_il (X_l - X_i)
///
/// and the forces turn the bodies: without friction a shaft would hold a torque. The weights follow
/// the master's nodes along the surface:
///
///   P_il += |P_il| b.(X_l - mean)_t,   M b = e,   M = sum_l |P_il| (X_l - mean)_t (X_l - mean)_t'
///
/// which keeps their sum, and moves the mean point by -e. Where all facets at i are parallel to n_i
/// e is rounding, whatever the master is like (steps, rims), and the row stays as it is.
Matrix balanced(const Matrix& P, const Matrix& G, const std::vector<ContactNode>& nodes,
                const std::vector<Vec3>& X);

}  // namespace frictioncg::mortar
