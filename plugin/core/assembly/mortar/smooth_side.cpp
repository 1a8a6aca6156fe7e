#include "assembly/mortar/smooth_side.h"

namespace frictioncg::mortar {

/// A fan: corners of facets at a vertex, joined over the ridges between them.
SmoothSide::SmoothSide(const Side& side, const std::vector<Vec3>& X,
                       const std::vector<char>& smooth)
    : fan_at_(side.facets(), {-1, -1, -1}) {
  const int d = side.d;
  Groups corners(d * side.facets());
  for (std::size_t k = 0; k < side.joints.size(); ++k) {
    const auto [f, g] = side.joints[k].facet;
    for (Index i : side.joints[k].vertex)
      if (is_smooth(side, k, smooth))
        corners.join(d * f + position(side.facet(f), i), d * g + position(side.facet(g), i));
  }
  Faceted surface;
  surface.d = d;
  surface.is_moved = side.is_moved;
  std::map<Index, Index> number, fan_of_root;  // number: of the vertices of the side alone
  for (Index f = 0; f < side.facets(); ++f) {
    Faceted::Facet& facet = surface.facets.emplace_back();
    facet.normal = side.planes[f].normal;
    for (int v = 0; v < d; ++v) {
      const Index i = side.facet(f).node[v], next = static_cast<Index>(surface.X.size());
      facet.vertex[v] = number.emplace(i, next).first->second;
      if (facet.vertex[v] == next) surface.X.push_back(X[i]);
      const auto [at, is_new] =
          fan_of_root.emplace(corners.of(d * f + v), static_cast<Index>(surface.fans.size()));
      if (is_new) {
        surface.fans.emplace_back().vertex = facet.vertex[v];
        node_.push_back(i);
      }
      Fan& fan = surface.fans[at->second];
      fan.facets.push_back(f);
      fan.mean += side.planes[f].measure * side.planes[f].normal;
      fan_at_[f][v] = at->second;
    }
  }
  for (Fan& fan : surface.fans) fan.mean.normalize();
  normal_ = smooth_normals(surface);
  for (Fan& fan : surface.fans) facets_.push_back(std::move(fan.facets));
}

}  // namespace frictioncg::mortar
