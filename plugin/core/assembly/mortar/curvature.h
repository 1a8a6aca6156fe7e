#pragma once
#include "assembly/mortar/sloped.h"
#include "assembly/mortar/smooth_side.h"
#include "assembly/mortar/turning_normal.h"

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

  /// d delta/d lambda_v, as columns.
  Mat3 slopes(Index facet, const Vec3& lambda) const;
  /// Derivatives by the normals at the vertices, by SmoothSide's fans.
  using Bends = std::map<Index, Vec3>;
  /// Those of y.(q (n_a + n_b) / (1 + n_a.n_b)) of edge k: by places of its ends, and by normals.
  void add_slopes(Index facet, int k, const Vec3& y, Sloped& to, Bends& bends) const;
  /// Of normals, by places of the nodes around.
  void add_slopes(const Bends& bends, Sloped& to) const;

 private:
  const Turns& turns(Index fan) const;

  const Side& side_;
  const std::vector<Vec3>& X_;
  std::vector<char> smooth_joints_;
  SmoothSide smooth_;
  mutable std::map<Index, Turns> turns_;   ///< by fan, once it is asked for
  std::vector<std::array<Vec3, 3>> edge_;  ///< per facet: q (n_a + n_b) / (1 + n_a.n_b) [length]
  int d_;
};

}  // namespace frictioncg::mortar
