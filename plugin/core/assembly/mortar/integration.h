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
};

class Integration {
 public:
  Integration(const Side& slave, const Side& master, const std::vector<Vec3>& X,
              const Options& options);
  Moments over(const Part& part) const;
  /// Of a quadrature point, weighted.
  Real measure(const Part& part, const QuadraturePoint& point) const;

  /// Of the slave and of the master; null where the gap is that of the facets.
  const CurvedOffset* of_slave() const { return options_.smooth ? &slave_ : nullptr; }
  const CurvedOffset* of_master() const { return options_.smooth ? &master_ : nullptr; }

 private:
  Real weight(const Part& part, const Vec3& lambda) const;

  const std::vector<Vec3>& X_;
  const Options& options_;  ///< not smooth: the offset of the curved surfaces is 0
  CurvedOffset slave_, master_;
};

}  // namespace frictioncg::mortar
