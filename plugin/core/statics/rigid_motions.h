#pragma once
#include "model/system.h"

namespace frictioncg {

/// Motions of a body, or of several, that cost no energy: columns, orthonormal in the product of D.
/// Their number is found, not assumed: 3 or 6 for a free body, less where supports hold it.

/// The kernel of S (contact_dofs square), by inverse iteration on S + shift D.
DenseMatrix rigid_motions(const DenseMatrix& S, const Vector& D);

/// Where the mesh nodes lie, nodes x dimension, in some unit, from rigid modes (n x 3 or 6) in any
/// frames. mesh_node: n. 0 for what the dofs of a node that a support holds do not tell.
Eigen::MatrixXd places_of(const std::vector<Index>& mesh_node, int dimension,
                          const Eigen::MatrixXd& modes);

}  // namespace frictioncg
