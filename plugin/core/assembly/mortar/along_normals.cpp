#include "assembly/mortar/along_normals.h"

#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "assembly/mortar/clipping.h"
#include "assembly/mortar/search.h"

namespace frictioncg::mortar {

namespace {

constexpr Real infinite = std::numeric_limits<Real>::infinity();
/// A mean point lies on the normal where it misses by less than this share of what its row sums up.
constexpr Real balanced = 1e-10;
/// A point on the edge of two facets is to lie in one of them at least.
constexpr Real on_edge = -1e-9;

bool misses(const Matrix& G, Index k, const ContactNode& node, const std::vector<Vec3>& X) {
  Vec3 arm = Vec3::Zero();
  Real size = 0;
  for (Matrix::InnerIterator it(G, k); it; ++it) {
    const Vec3 way = it.value() * (X[it.col()] - X[node.node]);
    arm += way;
    size += way.norm();
  }
  return (arm - arm.dot(node.normal) * node.normal).norm() > balanced * size;
}

/// Of a facet that has x inside it, across a direction.
Plane across(int d, const Vec3& x, const Vec3& direction) {
  Plane plane;
  plane.normal = direction;
  plane.size = plane.measure = 1;
  const Vec3 first = d == 2 ? Vec3(-direction[1], direction[0], 0) : direction.unitOrthogonal();
  const Vec3 second = d == 2 ? Vec3::Zero() : Vec3(direction.cross(first));
  plane.B << first.transpose(), second.transpose();
  plane.origin = x - (first + second) / d;
  return plane;
}

/// A point of a facet, by its barycentric coordinates.
struct Hit {
  Index facet = -1;
  Vec3 lambda = Vec3::Zero();
};

/// Where lines meet a master.
class Lines {
 public:
  Lines(const Side& master, const std::vector<Vec3>& X)
      : master_(master), X_(X), tree_(master.d, master.surface.facets, master.planes, X) {}

  /// The nearest facet that faces it.
  Hit hit(const Vec3& x, const Vec3& n) {
    const int d = master_.d;
    const Plane base = across(d, x, n);
    const Vec2 xi(1. / d, d == 2 ? 0 : 1. / d);
    tree_.find({base, -infinite, infinite, true}, found_);
    Hit nearest;
    Real least = infinite;
    for (Index m : found_) {
      const Projection p = project(d, base, master_.facet(m), X_);
      if (!p.inverts || p.at(xi).head(d).minCoeff() < on_edge) continue;
      const Real distance = std::abs(p.distance(xi));
      if (distance >= least) continue;
      least = distance;
      nearest = {m, p.at(xi)};
    }
    return nearest;
  }

 private:
  const Side& master_;
  const std::vector<Vec3>& X_;
  FacetTree tree_;
  std::vector<Index> found_;
};

}  // namespace

Matrix along_normals(const Matrix& P, const Matrix& G, const std::vector<ContactNode>& nodes,
                     const std::vector<char>& of_master, const std::vector<Side>& masters,
                     const std::vector<Vec3>& X) {
  std::map<Index, Lines> lines;  // by pair
  std::vector<Eigen::Triplet<Real, Index>> change;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const ContactNode& node = nodes[k];
    if (!of_master[node.node] || !misses(G, static_cast<Index>(k), node, X)) continue;
    const Side& master = masters[node.pair];
    const Hit hit =
        lines.try_emplace(node.pair, master, X).first->second.hit(X[node.node], node.normal);
    if (hit.facet < 0) continue;
    for (Matrix::InnerIterator it(P, node.node); it; ++it)
      change.emplace_back(node.node, it.col(), -it.value());
    for (int v = 0; v < master.d; ++v)
      change.emplace_back(node.node, master.facet(hit.facet).node[v], hit.lambda[v]);
  }
  if (change.empty()) return P;
  Matrix by(P.rows(), P.cols());
  by.setFromTriplets(change.begin(), change.end());
  return Matrix(P + by).pruned(1., 0.);
}

}  // namespace frictioncg::mortar
