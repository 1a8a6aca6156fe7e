#pragma once
#include "assembly/mortar/topology.h"
#include "assembly/smooth_normals.h"

namespace frictioncg::mortar {

/// Cosine of 45 degrees and a little: ridges sharper than that are edges of the body.
constexpr Real sharp = 0.7;
/// Cosine of 10 degrees: labels that meet flatter are one surface, others where they split an arc.
constexpr Real one_surface = 0.985;

/// Tells of each joint whether the surface goes on over it; the other joints are edges of the body.
std::vector<char> joints_that_go_on(const Side& side);

/// The normals of the smooth surface, or of several, that the facets of a side stand for.
class SmoothSide {
 public:
  /// goes_on: of each joint.
  SmoothSide(const Side& side, const std::vector<Vec3>& X, const std::vector<char>& goes_on);

  const FanNormal& at(Index facet, int vertex) const { return normal_[fan_at_[facet][vertex]]; }
  /// A number of the surface at a vertex of a facet: facets around a vertex have the same one.
  Index fan(Index facet, int vertex) const { return fan_at_[facet][vertex]; }
  /// The node that a surface of this number is at, and its facets there.
  Index node(Index fan) const { return node_[fan]; }
  const std::vector<Index>& facets(Index fan) const { return facets_[fan]; }
  const Vec3& normal(Index fan) const { return normal_[fan].normal; }

 private:
  std::vector<std::array<Index, 3>> fan_at_;
  std::vector<FanNormal> normal_;
  std::vector<Index> node_;
  std::vector<std::vector<Index>> facets_;
};

}  // namespace frictioncg::mortar
