#pragma once
// Surfaces without bodies.
#include <functional>
#include <map>

#include "core/assembly/mortar/mortar.h"

namespace frictioncg::mortar::test {

struct Surfaces {
  Nodes nodes;
  std::vector<Pair> pairs{1};
  Options options;
  bool quadratic = false;

  explicit Surfaces(int d, bool quadratic_ = false) : quadratic(quadratic_) { nodes.dimension = d; }
  Mortar mortar() const { return Mortar(nodes, pairs, options); }

  /// The unit segment or square of n (x n) cells, in the first d - 1 coordinates, moved by `shape`;
  /// outward is up (side 1) or down (-1).
  Surface sheet(int n, int side, const std::function<Vec3(const Vec3&)>& shape, long label) {
    const int d = nodes.dimension, rows = d == 2 ? 0 : n;
    const Index base = static_cast<Index>(nodes.X.size());
    for (int y = 0; y <= rows; ++y)
      for (int x = 0; x <= n; ++x)
        nodes.X.push_back(shape(Vec3(Real(x) / n, d == 2 ? 0 : Real(y) / n, 0)));
    Surface surface;
    surface.quadratic = quadratic;
    surface.labels = {label};
    const auto id = [&](int x, int y) { return base + x + (n + 1) * y; };
    for (int y = 0; y < std::max(rows, 1); ++y)
      for (int x = 0; x < n; ++x) {
        if (d == 2) {
          add(surface, {id(x, 0), id(x + 1, 0)}, side, label);
          continue;
        }
        add(surface, {id(x, y), id(x + 1, y), id(x + 1, y + 1)}, side, label);
        add(surface, {id(x, y), id(x + 1, y + 1), id(x, y + 1)}, side, label);
      }
    return surface;
  }

  /// Facets given by vertices, with mid-edges where quadratic.
  void add(Surface& surface, const std::vector<Index>& vertices, int side, long label) {
    const int d = nodes.dimension;
    Facet facet;
    facet.label = label;
    facet.outward = side * Vec3::Unit(d - 1);
    std::copy(vertices.begin(), vertices.end(), facet.node.begin());
    for (int k = 0; quadratic && k < edges_of_facet(d); ++k) {
      const auto [p, q] = edge_ends(d, k);
      const Index a = facet.node[p], b = facet.node[q];
      const auto at = middle.emplace(std::make_pair(std::min(a, b), std::max(a, b)),
                                     static_cast<Index>(nodes.X.size()));
      if (at.second) nodes.X.push_back((nodes.X[a] + nodes.X[b]) / 2);
      facet.node[d + k] = at.first->second;
    }
    surface.facets.push_back(facet);
  }
  std::map<std::pair<Index, Index>, Index> middle;
};

/// A sheet as it is, or at height z, where it reaches along the first coordinate so far.
inline Vec3 same(const Vec3& x) { return x; }
inline std::function<Vec3(const Vec3&)> lifted(int d, Real z, Real from = 0, Real to = 1) {
  return [=](const Vec3& x) {
    Vec3 y = x;
    y[0] = from + (to - from) * y[0];
    y[d - 1] = z;
    return y;
  };
}

inline void append(Surface& surface, const Surface& more) {
  surface.facets.insert(surface.facets.end(), more.facets.begin(), more.facets.end());
}

/// Turns the nodes, and what is outward.
inline void turn(const Eigen::Matrix3d& Q, Surfaces& s) {
  for (Vec3& x : s.nodes.X) x = Q * x;
  for (Pair& pair : s.pairs)
    for (Surface* surface : {&pair.slave, &pair.master})
      for (Facet& f : surface->facets) f.outward = Q * f.outward;
}

/// Bodies that may move by the columns of of_body, of generators, and are held otherwise.
inline void set_free(const std::vector<DenseMatrix>& of_body, Freedom& freedom) {
  freedom.of_body = of_body;
  freedom.stiffness.clear();
  for (const DenseMatrix& V : of_body) {
    const DenseMatrix all = DenseMatrix::Identity(V.rows(), V.rows()),
                      Q = V.cols() == 0 ? V : orthonormal(V);
    freedom.stiffness.push_back((1 + 1e-10) * all - Q * Q.transpose());
  }
}

/// |T W - I|
inline Real error_of_inverse(const Mortar& mortar, const std::vector<char>& held = {}) {
  const Matrix T = mortar.change_of_basis(held), W = mortar.inverse_basis(held);
  Matrix I(T.rows(), T.rows());
  I.setIdentity();
  return Matrix(Matrix(T * W) - I).norm();
}

}  // namespace frictioncg::mortar::test
