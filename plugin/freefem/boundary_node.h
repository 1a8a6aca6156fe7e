#pragma once
#include "freefem.h"

#include "../core/assembly/local_system.h"

namespace frictioncg {

/// A facet of the contact boundary as one of its nodes sees it.
struct AdjacentFacet {
  long label = 0;
  int element = 0, facet = 0;
  Fem2D::R3 hat;          ///< the node's place in the element
  Fem2D::R3 normal;       ///< outward, of the measure of the facet [length^(d-1)]
  double share = 0;       ///< integral of the node's shape function over the facet
  std::size_t place = 0;  ///< among the facets of the boundary
  double own = 0;         ///< Dimension::own
  Fem2D::R3 deciding;     ///< the normal by which facets are one obstacle to a node, or several
};

/// A node of the mesh on the contact boundary.
struct SharedNode {
  std::array<Index, 3> dof{{-1, -1, -1}};  ///< of each component of the displacement
  Fem2D::R3 x;                             ///< on its straight facets
  Fem2D::R3 moved;                         ///< by the displacement at which the geometry is
  Fem2D::R3 aside;                         ///< by so much a P2 mid-edge lies beside x
  std::vector<AdjacentFacet> facets;       ///< in the order in which the labels were given
};

/// A facet of the contact boundary by its nodes, as places among those of the boundary: the
/// vertices, then the middle of the edge opposite each of them, in 2D of the only edge.
struct BoundaryFacet {
  long label = 0;
  Fem2D::R3 normal;  ///< outward, of the measure of the facet [length^(d-1)]
  std::vector<std::size_t> node;
  int element = 0, facet = 0;  ///< the latter has the number of the vertex opposite
};

struct Boundary {
  std::vector<SharedNode> nodes;
  std::vector<BoundaryFacet> facets;
};

/// A contact point as FreeFEM sees it: one normal of a node, where to evaluate expressions, and its
/// share of the boundary. A node in a corner has several.
struct BoundaryNode {
  ContactPoint point;
  Fem2D::R3 x;
  long label = 0;
  double weight = 0;  ///< integral of its shape function over the facets of this normal, weighted
  int element = 0, facet = 0;
  int space = 0;          ///< of two spaces, whose elements these are: 0 or 1
  Fem2D::R3 hat;          ///< its place in the element
  Fem2D::R3 moved;        ///< already, against what it touches: the laws bound it with what follows
  Fem2D::R3 aside;        ///< as SharedNode's
  Fem2D::R3 slid;         ///< mortar/slip.h: what its motion since uold lacks of its slip
  Fem2D::R3 mean;         ///< mean outward normal of all facets at the node; 0 where they cancel
  double turn = 0;        ///< angle to its facets, of a curved surface; 0 where that is flat
  bool averaged = false;  ///< it stands for more normals than the node can obey
  std::vector<AdjacentFacet> facets;    ///< of this normal; none between two bodies
  std::shared_ptr<BoundaryNode> begun;  ///< itself where the increment began; null: here
  bool is_begun = false;                ///< it is such a one
  const BoundaryNode& deciding() const { return begun ? *begun : *this; }
};

/// The dofs of a node of the second of two spaces among those of both.
inline std::array<Index, 3> shifted(Index offset, int d, std::array<Index, 3> dof) {
  for (int c = 0; c < d; ++c) dof[c] += offset;
  return dof;
}

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
