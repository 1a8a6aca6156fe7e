#pragma once
#include <Eigen/Geometry>

#include "types.h"

namespace frictioncg::mortar {

using Vec2 = Eigen::Vector2d;  ///< 2D: second component 0
using Shape = std::array<Real, 6>;

/// "(x, y)" or "(x, y, z)".
std::string place(int d, const Vec3& x);

/// A facet of the boundary: a segment in 2D, a triangle in 3D, straight also where the space is P2.
/// Nodes: the vertices, then with P2 the mid-edges; edge k of a triangle lies opposite vertex k.
struct Facet {
  std::array<Index, 6> node{{-1, -1, -1, -1, -1, -1}};
  Vec3 outward = Vec3::Zero();  ///< any vector towards the outside: it chooses the normal's sign
  long label = 0;
  /// The vertex of the element opposite a facet of a master; -1 where it lies over a seam.
  Index behind = -1;
  bool one_body = false;      ///< of a master: with its slave
  Index body = -1;            ///< its number; -1 where the sides are in two spaces of one process
  Real thickness = infinity;  ///< of the body behind it; infinite where it is unknown [length]
};

/// One side of a contact pair, as a mesh has it.
struct Surface {
  bool quadratic = false;    ///< P2: facets have mid-edge nodes
  std::vector<long> labels;  ///< in the order the script lists them
  std::vector<Facet> facets;
};

/// Slave and master of one contact; pairs share the numbering of nodes. Where both are the same
/// facets the surface touches itself (self_contact.h).
struct Pair {
  Surface slave, master;
  bool itself = false;  ///< a part of one that touches itself
  Index given = 0;      ///< number of the pair that it is or is a part of
};

/// What two lists of labels, not empty, stand for: of equal length, slave[k] faces master[k]; a
/// single label faces all of the other list. A slave label that is named several times faces the
/// union of its masters, and slave labels that face the same masters are one surface. In one space
/// equal lists are one surface, which touches itself. Pairs without facets. Throws IllegalInput for
/// other lengths.
std::vector<Pair> label_pairs(const std::vector<long>& slave, const std::vector<long>& master,
                              bool in_one_space);

/// "label 1" or "labels 1, 2".
std::string labels_of(const Surface& surface);

/// Ends of edge k of a facet in d dimensions, as local vertices.
inline std::array<int, 2> edge_ends(int d, int k) {
  return d == 2 ? std::array<int, 2>{0, 1} : std::array<int, 2>{(k + 1) % 3, (k + 2) % 3};
}
/// A vertex of the reference facet.
inline Vec2 reference_vertex(int v) { return Vec2(v == 1, v == 2); }
/// Of a node on a facet, where it is in Facet::node.
inline int position(const Facet& facet, Index node) {
  return static_cast<int>(std::find(facet.node.begin(), facet.node.end(), node) -
                          facet.node.begin());
}
Vec3 centre_of(int d, const Facet& facet, const std::vector<Vec3>& X);
inline int edges_of_facet(int d) { return d == 2 ? 1 : 3; }
inline int nodes_of_facet(int d, bool quadratic) { return quadratic ? d + edges_of_facet(d) : d; }

/// Values of the trace functions at barycentric coordinates lambda, in the order of Facet::node.
Shape shape_functions(int d, bool quadratic, const Vec3& lambda);

/// The plane of a facet. Reference coordinates xi = B (x - origin), constant along the normal, have
/// the barycentric coordinates (1 - xi_1 - xi_2, xi_1, xi_2).
struct Plane {
  Vec3 origin = Vec3::Zero();                                       ///< vertex 0
  Vec3 normal = Vec3::Zero();                                       ///< unit, outward
  Eigen::Matrix<Real, 2, 3> B = Eigen::Matrix<Real, 2, 3>::Zero();  ///< 2D: second row 0
  Real measure = 0;                                                 ///< [length^(d-1)]
  Real size = 0;                                                    ///< longest edge [length]
};

/// Throws IllegalInput for a facet without extent.
Plane plane_of(int d, const Facet& facet, const std::vector<Vec3>& X);

}  // namespace frictioncg::mortar
