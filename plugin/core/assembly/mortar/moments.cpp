#include "assembly/mortar/moments.h"

#include <tuple>

#include "assembly/mortar/clipping.h"
#include "assembly/mortar/search.h"
#include "linear_algebra.h"

namespace frictioncg::mortar {

namespace {

/// A mean point lies on the normal where it misses by less than this share of what its row sums up;
/// once weights have followed it, less than the second share.
constexpr Real on_normal = 1e-14, balanced_to = 1e-10;

/// Lines that pass a facet at this share of the widest column meet it: edges belong to both facets.
constexpr Real on_edge = 1e-9;
/// Columns to search, as a share of the widest one, and how they grow: what is met costs little.
constexpr Real narrowest = 1e-3, wider = 4;
/// Gaps of two bodies that turn as one are closed up to this share of an element: beyond, forces
/// would act within the master for want of friction. Two surfaces between vertices of one curved
/// face are apart by that much on coarse meshes.
constexpr Real closed = 0.03;

/// Weights move by up to `narrow` of a barycentric coordinate, which is about the gap over the
/// height of the element; what asks for more fades out towards `widest`. A node beyond the master's
/// corner sees it by up to 0.7 of an element, a thin ring's beside coarse chords by 0.2.
constexpr Real narrow = 0.8, widest = 1.2;

/// From the node i of row k of G to the mean point that the row sees, and what it is summed of.
struct Arm {
  Vec3 sum = Vec3::Zero();  ///< sum_l G_kl (X_l - X_i)
  Real size = 0;
  Vec3 aside;       ///< what of it lies across n_i
  Real widest = 0;  ///< how far aside of the normal the row sees something, at most

  Arm(const Matrix& G, std::size_t k, const SlaveNode& node, const std::vector<Vec3>& X) {
    const auto across = [&n = node.normal](const Vec3& way) { return Vec3(way - way.dot(n) * n); };
    for (Matrix::InnerIterator it(G, static_cast<Index>(k)); it; ++it) {
      const Vec3 way = X[it.col()] - X[node.node];
      sum += it.value() * way;
      size += (it.value() * way).norm();
      widest = std::max(widest, across(way).norm());
    }
    aside = across(sum);
  }
};

Matrix changed(const Matrix& P, const EntryList& change) {
  if (change.empty()) return P;
  return Matrix(P + sparse(P.rows(), P.cols(), change)).pruned(1., 0.);
}

}  // namespace

Matrix balanced(const Matrix& P, const Matrix& G, const std::vector<SlaveNode>& nodes,
                const std::vector<Vec3>& X, RowChoices& choices) {
  Matrix result = P;
  const auto [row, col, weight] = arrays_of(P);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Arm arm(G, k, nodes[k], X);
    if (arm.aside.norm() <= on_normal * arm.size) continue;
    const Index first = row[nodes[k].node], size = row[nodes[k].node + 1] - first;
    const Vector w = Eigen::Map<const Vector>(weight + first, size).cwiseAbs();
    Eigen::Matrix3Xd q(3, size);
    for (Index l = 0; l < size; ++l) q.col(l) = X[col[first + l]];
    Vec3 mean = Vec3::Zero();             // of a row that sees one point that point, bit by bit
    for (int pass = 0; pass < 2; ++pass)  // the second takes off what rounding leaves
      mean += Vec3((q.colwise() - mean) * w / w.sum());
    const Vec3& n = nodes[k].normal;
    q = (Eigen::Matrix3d::Identity() - n * n.transpose()) * (q.colwise() - mean);
    const Eigen::Matrix3d M = q * w.asDiagonal() * q.transpose();
    RowChoice& choice = choices[nodes[k].node];
    Index& rank = choice.rank;
    const Vector change = q.transpose() * least_squares(M, arm.aside, singular(rank), &rank);
    const Real part = std::min(1., choice.most_change / change.lpNorm<Eigen::Infinity>());
    Eigen::Map<Vector>(result.valuePtr() + first, size) += part * w.cwiseProduct(change);
  }
  return result;
}

namespace {

/// Of a facet that has all inside it that is within `reach` of x, across a direction.
Plane across(int d, const Vec3& x, const Vec3& direction, Real reach) {
  Plane plane;
  plane.normal = direction;
  plane.size = plane.measure = 5 * reach;
  const Vec3 first = d == 2 ? Vec3(-direction[1], direction[0], 0) : direction.unitOrthogonal();
  const Vec3 second = d == 2 ? Vec3::Zero() : Vec3(direction.cross(first));
  plane.B << first.transpose() / plane.size, second.transpose() / plane.size;
  plane.origin = x - plane.size / d * (first + second);
  return plane;
}

/// A point of a facet, by its barycentric coordinates.
struct Hit {
  Index facet = -1;
  Vec3 lambda = Vec3::Zero();
  Real aside = infinity, along = infinity;  ///< distances of the line, and on it [length]
  bool operator<(const Hit& o) const { return std::tie(aside, along) < std::tie(o.aside, o.along); }
};

/// Where lines meet a master, or come nearest to it.
class Lines {
 public:
  Lines(const Side& master, const std::vector<Vec3>& X)
      : master_(master), X_(X), tree_(master.d, master.surface.facets, master.planes, X) {}

  /// On the nearest facet that faces it; none where all are further aside than `column`.
  Hit hit(const Vec3& x, const Vec3& n, Real column) {
    if (!(column > 0)) return {};
    for (Real reach = narrowest * column;; reach *= wider) {
      const Plane base = across(master_.d, x, n, reach);
      tree_.find({base, -infinity, infinity, true}, found_);
      Hit nearest;
      for (Index m : found_) nearest = std::min(nearest, on(m, base, on_edge * column));
      if (nearest.aside <= reach || reach > column) return nearest;
    }
  }

 private:
  /// The point of facet m that is nearest to the line through the middle of the base.
  Hit on(Index m, const Plane& base, Real none) const {
    const int d = master_.d;
    const Facet& facet = master_.facet(m);
    const Vec2 xi(1. / d, d == 2 ? 0 : 1. / d);
    const Projection p = project(d, base, facet, X_);
    Hit here;
    if (!p.inverts) return here;
    here = {m, p.at(xi), 0, std::abs(p.distance(xi))};
    if (here.lambda.head(d).minCoeff() >= 0) return here;
    Hit rim{m, Vec3::Zero(), infinity, 0};
    for (int k = 0; k < edges_of_facet(d); ++k) {
      const auto [v, w] = edge_ends(d, k);
      const Vec2 a = base.B * (X_[facet.node[v]] - base.origin) - xi;
      const Vec2 ab = base.B * (X_[facet.node[w]] - X_[facet.node[v]]);
      const Real t = std::clamp<Real>(-a.dot(ab) / ab.squaredNorm(), 0, 1);
      const Real aside = (a + t * ab).norm() * base.size;
      if (aside >= rim.aside) continue;
      rim = {m, Vec3::Zero(), aside, std::abs(p.distance(xi + a + t * ab))};
      rim.lambda[v] = 1 - t, rim.lambda[w] = t;
    }
    return rim.aside > none ? rim : here;
  }

  const Side& master_;
  const std::vector<Vec3>& X_;
  FacetTree tree_;
  std::vector<Index> found_;
};

}  // namespace

Matrix along_normals(const Matrix& P, const Matrix& G, const std::vector<SlaveNode>& nodes,
                     const std::vector<char>& of_master, const std::vector<Side>& masters,
                     const std::vector<Vec3>& X, RowChoices& choices) {
  std::map<Index, Lines> lines;  // by pair
  EntryList change;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const SlaveNode& node = nodes[k];
    if (!of_master[node.node]) continue;
    const Arm arm(G, k, node, X);
    std::optional<bool>& along = choices[node.node].along_normal;
    if (!along) along = arm.aside.norm() > balanced_to * arm.size;
    if (!*along) continue;
    const Side& master = masters[node.pair];
    Lines& to = lines.try_emplace(node.pair, master, X).first->second;
    const Hit hit = to.hit(X[node.node], node.normal, arm.widest);
    if (hit.facet < 0) continue;
    Real sum = 0;  // of the row, which stays: 1 but where removed nodes have weights of their own
    for (Matrix::InnerIterator it(P, node.node); it; ++it) {
      sum += it.value();
      change.emplace_back(node.node, it.col(), -it.value());
    }
    for (int v = 0; v < master.d; ++v)
      change.emplace_back(node.node, master.facet(hit.facet).node[v], sum * hit.lambda[v]);
  }
  return changed(P, change);
}

namespace {

/// grad lambda_l of the vertices of a simplex, as rows: their sum is 0, and that of times X_l is 1.
DenseMatrix gradients_of(const std::vector<Index>& vertices, const std::vector<Vec3>& X) {
  const int d = static_cast<int>(vertices.size()) - 1;
  DenseMatrix edges(d, d), gradients = DenseMatrix::Zero(d + 1, 3);
  for (int k = 0; k < d; ++k) edges.col(k) = (X[vertices[k]] - X[vertices[d]]).head(d);
  gradients.topLeftCorner(d, d) = least_squares(edges, DenseMatrix::Identity(d, d));
  gradients.row(d) = -gradients.topRows(d).colwise().sum();
  return gradients;
}

/// Of the vertices behind a facet and behind those beside it, the deepest that is none of `later`.
template <class Later>
Index deepest_behind(const Facet& facet, const std::map<const Facet*, Real>& beside,
                     const Later& later, const Nodes& all) {
  const Plane face = plane_of(all.dimension, facet, all.X);
  const auto depth = [&](Index l) { return face.normal.dot(face.origin - all.X[l]); };
  Index deepest = facet.behind;
  for (const auto& [other, weight] : beside)
    if (const Index l = other->behind; l >= 0 && !later(l) && depth(l) > depth(deepest))
      deepest = l;
  return deepest;
}

}  // namespace

Crossings crossings(const Matrix& G, const std::vector<SlaveNode>& nodes, const Nodes& all,
                    const std::vector<char>& turns, const FacedFacets& faced) {
  const bool apart = !all.before.empty();
  std::vector<Index> pair_of(all.X.size(), -1);  // whose law a node has
  for (const SlaveNode& node : nodes) pair_of[node.node] = node.pair;
  Crossings found(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto& [i, pair, label, n, D, g, distance, own] = nodes[k];
    const Vec3 arm = Arm(G, k, nodes[k], all.where_forces_act()).sum;
    const auto later = [&, of = pair](Index l) { return pair_of[l] >= of; };
    const auto by = [&, i = i](const Facet& facet, Index behind) {
      Crossing c;
      c.vertices.assign(facet.node.begin(), facet.node.begin() + all.dimension);
      c.vertices.push_back(behind);
      c.gradients = gradients_of(c.vertices, all.X);
      c.one_body = facet.one_body || (!apart && turns[i]);
      return c;
    };
    const auto change = [&, &n = n, g = g](const Crossing& c) {
      return (c.gradients * c.e(arm, n, g)).lpNorm<Eigen::Infinity>();
    };
    const auto is_open = [&, &n = n, g = g](const Facet& facet, const Crossing& c) {
      return !apart && !facet.one_body && g * (c.gradients * n).lpNorm<Eigen::Infinity>() > closed;
    };
    Real whole = 0;
    for (const auto& [facet, weight] : faced[i]) {
      if (facet->behind < 0 || !(apart || facet->one_body || turns[i])) continue;
      Crossing here = by(*facet, facet->behind);
      if (std::any_of(here.vertices.begin(), here.vertices.end(), later)) continue;
      // the vertex of a flat element may lie on the face, too: the deepest one does better
      if (!apart && (change(here) > narrow || is_open(*facet, here)))
        here = by(*facet, deepest_behind(*facet, faced[i], later, all));
      if (is_open(*facet, here)) continue;
      whole += weight;
      here.share = weight * std::clamp<Real>((widest - change(here)) / (widest - narrow), 0, 1);
      if (here.share > 0) found[k].push_back(std::move(here));
    }
    // what fades out is left to the others, as long as these are half of all
    const auto add = [](Real sum, const Crossing& c) { return sum + c.share; };
    const Real kept = std::accumulate(found[k].begin(), found[k].end(), Real(0), add);
    for (Crossing& c : found[k]) c.share /= std::max(kept, whole / 2);
  }
  return found;
}

Matrix across_gap(const Matrix& P, const Matrix& G, const std::vector<SlaveNode>& nodes,
                  const std::vector<Vec3>& X, const Crossings& crossings) {
  EntryList change;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const SlaveNode& at = nodes[k];
    const Vec3 arm = Arm(G, k, at, X).sum;
    for (const Crossing& crossing : crossings[k]) {
      const Vector c = crossing.gradients * (crossing.share * crossing.e(arm, at.normal, at.gap));
      for (std::size_t v = 0; v < crossing.vertices.size(); ++v)
        change.emplace_back(at.node, crossing.vertices[v], c[static_cast<Index>(v)]);
    }
  }
  return changed(P, change);
}

}  // namespace frictioncg::mortar
