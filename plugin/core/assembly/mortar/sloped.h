#pragma once
#include "assembly/mortar/surface.h"

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

}  // namespace frictioncg::mortar
