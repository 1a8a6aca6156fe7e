#pragma once
#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

/// Offset from the facets to the smooth surface through their vertices.   Nagata 2005
///
///   delta = sum over edges (a, b) of lambda_a lambda_b q (n_a + n_b) / (1 + n_a.n_b),
///   q = (n_b - n_a).(X_b - X_a) / 2
///
/// n: normals at the vertices, of each of the smooth surfaces that meet there: an edge of the body
/// (a sharp ridge, labels that meet at an angle, in 2D a kink between straight flanks) parts them,
/// and each has its own.
class CurvedOffset {
 public:
  CurvedOffset(const Side& side, const std::vector<Vec3>& X);
  Vec3 at(Index facet, const Vec3& lambda) const;

 private:
  std::vector<std::array<Vec3, 3>> edge_;  ///< per facet: q (n_a + n_b) / (1 + n_a.n_b) [length]
  int d_;
};

}  // namespace frictioncg::mortar
