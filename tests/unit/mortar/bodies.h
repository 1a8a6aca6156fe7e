#pragma once
// Bodies of triangles or tetrahedra, P1 or P2, and their elasticity: assembled here, without
// FreeFEM.
#include <Eigen/Geometry>

#include <functional>
#include <map>

#include "core/assembly/mortar/mortar.h"

namespace frictioncg::mortar::test {

using Element =
    std::vector<Index>;  ///< vertices, then with P2 the mid-edges in the order of ends()
using Map = std::function<Vec3(const Vec3&)>;

std::vector<std::array<int, 2>> ends(int d);

/// Several bodies with one numbering of nodes. Facets of the boundary carry outward vectors; labels
/// are given afterwards, by place.
struct MeshedBodies {
  int d = 2;
  bool quadratic = false;
  std::vector<Vec3> X;
  std::vector<Element> elements;
  std::vector<Real> E;  ///< per element
  Real nu = 0.3;

  /// Adds the unit square or cube of n[0] x n[1] (x n[2]) cells, deformed by `shape`.
  void add_box(std::array<int, 3> n, const Map& shape, Real young = 1);
  /// Makes nodes at one place one node, where `where` says so.
  void merge(const std::function<bool(const Vec3&)>& where);
  /// The boundary facets whose centroid `where` accepts; only elements first .. last-1.
  std::vector<Facet> boundary(const std::function<bool(const Vec3&)>& where, long label = 0,
                              Index first = 0, Index last = -1) const;
  Matrix stiffness() const;
  /// Adds the loads of a traction on a facet.
  void add_traction(const Facet& facet, const Vec3& traction, Vector& F) const;
  Vec3 centroid(const Element& e) const {
    Vec3 c = Vec3::Zero();
    for (int v = 0; v <= d; ++v) c += X[e[v]] / (d + 1);
    return c;
  }
  Index nodes() const { return static_cast<Index>(X.size()); }
};

/// Gradients of the shape functions at barycentric coordinates lambda (d + 1); one column each.
Eigen::MatrixXd gradients(int d, bool quadratic, const Eigen::MatrixXd& of_lambda,
                          const Eigen::VectorXd& lambda);

}  // namespace frictioncg::mortar::test
