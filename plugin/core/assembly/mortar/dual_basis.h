#pragma once
#include "assembly/mortar/surface.h"

namespace frictioncg::mortar {

/// Multipliers of one slave facet, biorthogonal over its covered part c:   Wohlmuth; Popp et al.
///
///   chi_j = lambda_j + (sum of lambda over removed vertices) / |K|,   j in K, the kept vertices
///   X_jk = int_c chi_j lambda_k,   d_k = int_c lambda_k,   psi_i = d_i sum_j (X^-1)_ij chi_j
///
/// so that int_c psi_i lambda_k = delta_ik d_i, and sum psi = 1.
struct DualBasis {
  Eigen::Matrix3d psi =
      Eigen::Matrix3d::Zero();  ///< psi_i = sum_v psi(i, v) lambda_v; 0 if not kept
  Vec3 d = Vec3::Zero();        ///< [length^(d-1)]; 0 if not kept
};

/// M(v, w) = int_c lambda_v lambda_w [length^(d-1)]; kept: of the d vertices.
DualBasis dual_basis(int d, const Eigen::Matrix3d& M, const std::array<bool, 3>& kept);

}  // namespace frictioncg::mortar
