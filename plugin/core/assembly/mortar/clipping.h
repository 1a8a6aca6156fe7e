#pragma once
#include "assembly/mortar/surface.h"

namespace frictioncg::mortar {

/// A convex polygon in the reference coordinates of a slave facet; in 2D a segment of two points.
using Polygon = std::vector<Vec2>;

/// c + g.xi
struct Affine {
  Real c = 0;
  Vec2 g = Vec2::Zero();
  Real operator()(const Vec2& xi) const { return c + g.dot(xi); }
};

/// The whole reference facet.
Polygon reference_facet(int d);

/// The part of a polygon where f >= 0, or with side = -1 where f <= 0.   Sutherland and Hodgman
Polygon cut(const Polygon& polygon, const Affine& f, int side = 1);

/// Area, in 2D length, in reference coordinates: 1/2, in 2D 1, is the whole facet.
Real extent(const Polygon& polygon);
Vec2 centroid(const Polygon& polygon);

/// Barycentric coordinates of a master facet at the points chi(xi) of it that lie on the normal of
/// the slave facet through xi.
struct Projection {
  std::array<Affine, 3> lambda;
  Affine distance;  ///< along the normal of the slave [length]; < 0: the bodies overlap
  bool inverts = false;
  Vec3 at(const Vec2& xi) const { return {lambda[0](xi), lambda[1](xi), lambda[2](xi)}; }
};
Projection project(int d, const Plane& slave, const Facet& master, const std::vector<Vec3>& X);

/// The part of a polygon before the master facet.
Polygon inside(int d, Polygon polygon, const Projection& master);
/// What is left of a polygon outside of it, as convex pieces.
std::vector<Polygon> outside(int d, Polygon polygon, const Projection& master);

/// Points and weights that integrate degree 4 (2D: 5) over a polygon; the weights sum to extent().
struct QuadraturePoint {
  Vec2 xi;
  Real weight;
};
void quadrature(const Polygon& polygon, std::vector<QuadraturePoint>& points);

/// Barycentric coordinates of the slave facet at xi.
inline Vec3 slave_coordinates(int d, const Vec2& xi) {
  return d == 2 ? Vec3(1 - xi[0], xi[0], 0) : Vec3(1 - xi[0] - xi[1], xi[0], xi[1]);
}

}  // namespace frictioncg::mortar
