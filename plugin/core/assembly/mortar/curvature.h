#pragma once
#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

/// Cosine of 45 degrees and a little: ridges sharper than that are edges of the body.
constexpr Real sharp = 0.7;
/// Cosine of 10 degrees: labels that meet flatter are one surface.
constexpr Real one_surface = 0.985;

/// Offset from the facets to the smooth surface through their vertices.   Nagata 2005
///
///   delta = sum over edges (a, b) of lambda_a lambda_b q (n_a + n_b) / (1 + n_a.n_b),
///   q = (n_b - n_a).(X_b - X_a) / 2
///
/// n: normals at the vertices, facet normals weighted by sin(angle)/(|e1| |e2|), in 2D by 1/h,
/// which is exact on spheres and circles. A vertex on the rim of the surface, or on an edge of the
/// body (a sharp ridge, labels that meet at an angle, in 2D a kink between straight flanks), takes
/// the normal that makes the edge to an inner vertex an arc, so that the inner vertex alone
/// decides.
class CurvedOffset {
 public:
  CurvedOffset(const Side& side, const std::vector<Vec3>& X);
  Vec3 at(Index facet, const Vec3& lambda) const;

 private:
  std::vector<std::array<Vec3, 3>> edge_;  ///< per facet: q (n_a + n_b) / (1 + n_a.n_b) [length]
  int d_;
};

}  // namespace frictioncg::mortar
