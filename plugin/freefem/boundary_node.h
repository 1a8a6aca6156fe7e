#pragma once
#include "freefem.h"

#include <sstream>
#include <string>
#include <vector>

#include "../core/assembly/local_system.h"

namespace frictioncg {

/// A facet of the contact boundary as one of its nodes sees it.
struct AdjacentFacet {
  long label = 0;
  Fem2D::R3 normal;  ///< outward, of the measure of the facet [length^(d-1)]
};

/// A contact node as FreeFEM sees it: where to evaluate expressions, and its share of the boundary.
struct BoundaryNode {
  ContactPoint point;
  Fem2D::R3 x;
  long label = 0;     ///< the first of the labels that share the node
  double weight = 0;  ///< integral of its shape function over the contact boundary [length^(d-1)]
  int element = 0, facet = 0;
  Fem2D::R3 hat;  ///< its place in the element
  std::vector<AdjacentFacet> facets;
};

inline Fem2D::R3 as_R3(const std::array<Real, 3>& a) { return Fem2D::R3(a[0], a[1], a[2]); }

/// Coordinates for messages: (x, y) or (x, y, z).
inline std::string coordinates(const Fem2D::R3& x, int dimension) {
  std::ostringstream s;
  s << "(" << x.x << ", " << x.y;
  if (dimension == 3) s << ", " << x.z;
  s << ")";
  return s.str();
}

/// Where a contact node is, for messages.
inline std::string place(const BoundaryNode& node, int dimension) {
  return coordinates(node.x, dimension) + " on label " + std::to_string(node.label);
}

}  // namespace frictioncg
