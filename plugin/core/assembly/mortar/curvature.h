#pragma once
#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

/// A number with its derivatives with respect to the places of nodes.
struct Sloped {
  Real value = 0;
  std::map<Index, Vec3> slope;  ///< by node; 0 of others

  void add(const Sloped& f, Real factor) {
    value += factor * f.value;
    for (const auto& [node, by] : f.slope) at(node) += factor * by;
  }
  Vec3& at(Index node) { return slope.try_emplace(node, Vec3::Zero()).first->second; }
  Vec3 by(Index node) const {
    const auto found = slope.find(node);
    return found == slope.end() ? Vec3(Vec3::Zero()) : found->second;
  }
};

using Mat3 = Eigen::Matrix3d;
using Turns = std::map<Index, Mat3>;  ///< dn/dX_j by j

/// Derivatives of the normal n of node i, which is along a sum over those of the facets around it
/// that are one surface with it,
///
///   n ~ sum_f n_f sin(alpha_f) / (|e_f| |e'_f|)
///
/// alpha_f the angle of facet f at the node, between the edges e_f and e'_f (2D: n_f / |e_f|):
/// exact on circles and spheres [Max]. In 2D that is the circle through the node and the two beside
/// it; at the end of a line of facets the next two vertices have the circle,
///
///   n ~ n_f / |e_f| - n' / |e'|
///
/// e' to the farther one, n' across it.   smooth: as in is_smooth
Turns turns_of_normal(Index i, const Vec3& n, const std::vector<Index>& facets, const Side& side,
                      const std::vector<Vec3>& X, const std::vector<char>& smooth = {});

/// Offset from the facets to the smooth surface through their vertices.   Nagata 2005
///
///   delta = sum over edges (a, b) of lambda_a lambda_b q (n_a + n_b) / (1 + n_a.n_b),
///   q = (n_b - n_a).(X_b - X_a) / 2
///
/// n: normals at the vertices, of each of the smooth surfaces that meet there: an edge of the body
/// (a sharp ridge, labels that meet at an angle, a kink between straight flanks) parts them,
/// and each has its own.
class CurvedOffset {
 public:
  /// reference: where bodies are not deformed, of P2, whose edges bend as they do: what these lack
  /// of the smooth surface is q of there. Empty: X.
  CurvedOffset(const Side& side, const Side& other, const std::vector<Vec3>& X,
               const std::vector<Vec3>& reference = {});
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
  std::vector<std::array<Real, 3>> bow_;   ///< per facet: q [length]
  std::vector<std::array<Vec3, 3>> edge_;  ///< per facet: q (n_a + n_b) / (1 + n_a.n_b) [length]
  bool of_reference_;                      ///< q
  int d_;
};

}  // namespace frictioncg::mortar
