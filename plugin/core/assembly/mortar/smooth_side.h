#pragma once
#include "assembly/mortar/topology.h"
#include "assembly/smooth_normals.h"

namespace frictioncg::mortar {

/// Whether the facets of joint k have common normals at it. smooth: of each joint, or empty: where
/// the surface goes on.
inline bool is_smooth(const Side& side, std::size_t k, const std::vector<char>& smooth) {
  return smooth.empty() ? side.joints[k].goes_on : smooth[k] != 0;
}

/// The normals of the smooth surface, or of several, that the facets of a side stand for.
class SmoothSide {
 public:
  /// smooth: as in is_smooth.
  SmoothSide(const Side& side, const std::vector<Vec3>& X, const std::vector<char>& smooth = {});

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
