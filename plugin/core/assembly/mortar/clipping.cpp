#include "assembly/mortar/clipping.h"

#include <Eigen/LU>

namespace frictioncg::mortar {

Polygon reference_facet(int d) {
  if (d == 2) return {reference_vertex(0), reference_vertex(1)};
  return {reference_vertex(0), reference_vertex(1), reference_vertex(2)};
}

Polygon cut(const Polygon& polygon, const Affine& f, int side) {
  Polygon kept;
  const std::size_t n = polygon.size();
  const std::size_t edges = n == 2 ? 1 : n;  // a segment does not close
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 &a = polygon[k], &b = polygon[(k + 1) % n];
    const Real fa = side * f(a), fb = side * f(b);
    if (fa >= 0) kept.push_back(a);
    if (k < edges && ((fa > 0 && fb < 0) || (fa < 0 && fb > 0)))
      kept.push_back(a + fa / (fa - fb) * (b - a));
  }
  if (kept.size() < std::min<std::size_t>(n, 3)) kept.clear();
  return kept;
}

Real extent(const Polygon& p) {
  if (p.size() == 2) return std::abs(p[1][0] - p[0][0]);
  Real twice = 0;
  for (std::size_t k = 2; k < p.size(); ++k) {
    const Vec2 a = p[k - 1] - p[0], b = p[k] - p[0];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return std::abs(twice) / 2;
}

Vec2 centroid(const Polygon& p) {
  Vec2 sum = Vec2::Zero();
  for (const Vec2& xi : p) sum += xi;
  return sum / static_cast<Real>(p.size());
}

Projection project(int d, const Plane& slave, const Facet& master, const std::vector<Vec3>& X) {
  Projection p;
  // [1; xi] = M lambda over the projected vertices
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
  Vec3 height = Vec3::Zero();
  for (int v = 0; v < d; ++v) {
    const Vec3 x = X[master.node[v]] - slave.origin;
    M.col(v) << 1, slave.B * x;
    height[v] = slave.normal.dot(x);
  }
  if (d == 2) M.row(2).setZero(), M.col(2) = Vec3::UnitZ();
  Eigen::Matrix3d inverse;
  M.computeInverseWithCheck(inverse, p.inverts, 0);
  if (!p.inverts) return p;
  if (d == 2) inverse.row(2).setZero();
  for (int v = 0; v < 3; ++v) {
    p.lambda[v].c = inverse(v, 0);
    p.lambda[v].g = inverse.row(v).tail<2>().transpose();
    p.distance.c += height[v] * p.lambda[v].c;
    p.distance.g += height[v] * p.lambda[v].g;
  }
  return p;
}

Polygon inside(int d, Polygon polygon, const Projection& master) {
  for (int v = 0; v < d && !polygon.empty(); ++v) polygon = cut(polygon, master.lambda[v]);
  return polygon;
}

std::vector<Polygon> outside(int d, Polygon polygon, const Projection& master) {
  std::vector<Polygon> pieces;
  for (int v = 0; v < d && !polygon.empty(); ++v) {
    Polygon piece = cut(polygon, master.lambda[v], -1);
    if (static_cast<int>(piece.size()) >= d) pieces.push_back(std::move(piece));
    polygon = cut(polygon, master.lambda[v]);
  }
  return pieces;
}

namespace {

void add_segment(const Polygon& p, std::vector<QuadraturePoint>& points) {
  const Real length = std::abs(p[1][0] - p[0][0]), root = std::sqrt(0.6);
  const Vec2 middle = (p[0] + p[1]) / 2, half = (p[1] - p[0]) / 2;
  points.push_back({middle - root * half, length * 5 / 18});
  points.push_back({middle, length * 8 / 18});
  points.push_back({middle + root * half, length * 5 / 18});
}

/// Six points of degree 4, in closed form.   Strang and Fix; Dunavant
void add_triangle(const Vec2& p, const Vec2& q, const Vec2& r,
                  std::vector<QuadraturePoint>& points) {
  static const Real s10 = std::sqrt(10.0), t = std::sqrt(38 - 44 * std::sqrt(0.4));
  static const Real a[2] = {(8 - s10 + t) / 18, (8 - s10 - t) / 18};
  static const Real u = std::sqrt(213125 - 53320 * s10);
  static const Real w[2] = {(620 + u) / 3720, (620 - u) / 3720};
  const Real area = extent({p, q, r});
  for (int k = 0; k < 2; ++k) {
    const Real b = 1 - 2 * a[k];
    points.push_back({a[k] * p + a[k] * q + b * r, area * w[k]});
    points.push_back({a[k] * p + b * q + a[k] * r, area * w[k]});
    points.push_back({b * p + a[k] * q + a[k] * r, area * w[k]});
  }
}

}  // namespace

void quadrature(const Polygon& polygon, std::vector<QuadraturePoint>& points) {
  points.clear();
  if (polygon.size() == 2) add_segment(polygon, points);
  for (std::size_t k = 2; k < polygon.size(); ++k)
    add_triangle(polygon[0], polygon[k - 1], polygon[k], points);
}

}  // namespace frictioncg::mortar
