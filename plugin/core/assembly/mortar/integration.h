#pragma once
#include "assembly/mortar/cover.h"
#include "assembly/mortar/curvature.h"
#include "assembly/mortar/mortar.h"

namespace frictioncg::mortar {

/// A slave facet and what covers it.
struct Part {
  const Side &slave, &master;
  Index facet;  ///< of the slave
  const std::vector<Cell>& cells;
  Index node(int k) const { return slave.facet(facet).node[k]; }
};

/// Integrals over the covered part of a slave facet, weighted, of each lambda_v times ...
struct Moments {
  Eigen::Matrix3d vertices = Eigen::Matrix3d::Zero();  ///< ... lambda_w
  Eigen::Matrix3d edges = Eigen::Matrix3d::Zero();     ///< ... phi_e
  Eigen::Matrix3d offset = Eigen::Matrix3d::Zero();    ///< ... delta_m(chi) - delta_s, row v
  std::vector<Eigen::Matrix<Real, 3, 6>> master;       ///< ... phi^m_l(chi), one per cell
  Vec3 distance = Vec3::Zero();                        ///< of phi_e times the distance
  /// Along the slave's normal: the least distance of the facets, and by how much curved surfaces
  /// lie beside them.
  Real least = infinity, bulge = 0;
};

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

class Integration {
 public:
  Integration(const Side& slave, const Side& master, const Nodes& nodes, const Options& options);
  Moments over(const Part& part) const;
  /// Of a quadrature point, weighted.
  Real measure(const Part& part, const QuadraturePoint& point) const;

  /// Of the slave and of the master; null where the gap is that of the facets.
  const CurvedOffset* of_slave() const { return options_.smooth ? &slave_ : nullptr; }
  const CurvedOffset* of_master() const { return options_.smooth ? &master_ : nullptr; }

 private:
  /// From a point of a facet with straight edges to that with edges that bend.
  Vec3 bend_at(const Facet& facet, const Vec3& lambda) const;

  const Nodes& nodes_;
  const Options& options_;  ///< not smooth: the offset of the curved surfaces is 0
  CurvedOffset slave_, master_;
};

}  // namespace frictioncg::mortar
