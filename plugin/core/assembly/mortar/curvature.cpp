#include "assembly/mortar/curvature.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

namespace frictioncg::mortar {

namespace {

/// Of the turns beside it: a kink that turns so much more is no part of an arc.
constexpr Real lone = 4;

enum class Place : char { inner, rim, ridge };

/// Sum over the facets at each vertex; normalized.
std::vector<Vec3> vertex_normals(const Side& side, const std::vector<Vec3>& X) {
  std::vector<Vec3> normal(X.size(), Vec3::Zero());
  for (Index f = 0; f < side.facets(); ++f) {
    const auto& node = side.facet(f).node;
    const Plane& plane = side.planes[f];
    for (int v = 0; v < side.d; ++v) {
      Real weight = 1 / plane.measure;
      if (side.d == 3) {
        const Vec3 e1 = X[node[(v + 1) % 3]] - X[node[v]], e2 = X[node[(v + 2) % 3]] - X[node[v]];
        weight = e1.cross(e2).norm() / (e1.squaredNorm() * e2.squaredNorm());
      }
      normal[node[v]] += weight * plane.normal;
    }
  }
  for (Vec3& n : normal) n.normalize();
  return normal;
}

/// The edges of the body: sharp ridges, those between labels that meet at an angle, and in 2D a
/// kink between straight flanks, where the surface does not go on turning.
std::vector<char> edges_of_body(const Side& side, std::size_t nodes) {
  std::vector<char> edge(side.joints.size());
  std::vector<Real> turn(side.joints.size());
  std::vector<std::array<Index, 2>> of_facet(side.facets(), {-1, -1});
  for (std::size_t k = 0; k < side.joints.size(); ++k) {
    const Joint& j = side.joints[k];
    const bool two_labels = side.facet(j.facet[0]).label != side.facet(j.facet[1]).label;
    edge[k] = j.cosine < (two_labels ? one_surface : sharp);
    turn[k] = std::acos(std::clamp(j.cosine, -1.0, 1.0));
    for (Index f : j.facet) of_facet[f][of_facet[f][0] < 0 ? 0 : 1] = static_cast<Index>(k);
  }
  if (side.d == 3 || nodes == 0) return edge;
  for (std::size_t k = 0; k < side.joints.size(); ++k) {
    if (side.joints[k].cosine >= one_surface) continue;
    Real beside = 0;
    for (Index f : side.joints[k].facet)
      for (Index other : of_facet[f])
        if (other >= 0 && other != static_cast<Index>(k)) beside = std::max(beside, turn[other]);
    edge[k] = edge[k] || turn[k] > lone * beside;
  }
  return edge;
}

std::vector<Place> places(const Side& side, std::size_t nodes) {
  std::vector<Place> place(nodes, Place::inner);
  const std::vector<char> edge = edges_of_body(side, nodes);
  for (const auto& ridge : side.rim) place[ridge[0]] = place[ridge[1]] = Place::rim;
  for (std::size_t k = 0; k < edge.size(); ++k)
    if (edge[k]) place[side.joints[k].vertex[0]] = place[side.joints[k].vertex[1]] = Place::ridge;
  return place;
}

/// The normal at the far end of an edge that is an arc, from the normal at the near end.
Vec3 mirrored(const Vec3& n, const Vec3& e) { return n - 2 * n.dot(e) / e.squaredNorm() * e; }

/// q (n_a + n_b) / (1 + n_a.n_b)
Vec3 arc(const Vec3& n_a, const Vec3& n_b, const Vec3& e) {
  const Real cosine = n_a.dot(n_b);
  if (cosine < 0) return Vec3::Zero();
  return (n_b - n_a).dot(e) / 2 / (1 + cosine) * (n_a + n_b);
}

/// Normals at the rim in 3D, where those of the facets see one side only: n with n.e = -n_a.e for
/// the edges e to inner vertices a, by least squares. Vertices whose edges leave a direction open
/// wait for their neighbours on the rim; in the end the mean of the mirrored normals decides there.
void resolve_rim(const Side& side, const std::vector<Vec3>& X, std::vector<Vec3>& normal,
                 std::vector<Place>& place) {
  struct Fit {
    Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
    Vec3 right = Vec3::Zero(), mirrored = Vec3::Zero();
  };
  for (int pass = 0; pass < 4; ++pass) {
    std::map<Index, Fit> fits;
    for (const Facet& facet : side.surface.facets)
      for (int p = 0; p < 3; ++p)
        for (int q = 0; q < 3; ++q) {
          const Index a = facet.node[p], b = facet.node[q];
          if (place[a] != Place::inner || place[b] != Place::rim) continue;
          const Vec3 e = (X[b] - X[a]).normalized();
          Fit& fit = fits[b];
          fit.M += e * e.transpose();
          fit.right -= normal[a].dot(e) * e;
          fit.mirrored += mirrored(normal[a], e);
        }
    for (const auto& [i, fit] : fits) {
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(fit.M);
      if (pass < 2 && spread.eigenvalues()[1] < 0.05 * spread.eigenvalues()[2]) continue;
      constexpr Real weak = 1e-4;
      const Eigen::Matrix3d M = fit.M + weak * Eigen::Matrix3d::Identity();
      normal[i] = M.ldlt().solve(fit.right + weak * fit.mirrored.normalized()).normalized();
      place[i] = Place::inner;
    }
  }
}

}  // namespace

CurvedOffset::CurvedOffset(const Side& side, const std::vector<Vec3>& X)
    : edge_(side.facets()), d_(side.d) {
  std::vector<Vec3> normal = vertex_normals(side, X);
  const std::vector<Place> place = places(side, X.size());
  std::vector<Place> resolved = place;
  if (d_ == 3) resolve_rim(side, X, normal, resolved);
  for (Index f = 0; f < side.facets(); ++f)
    for (int k = 0; k < edges_of_facet(d_); ++k) {
      const auto [p, q] = edge_ends(d_, k);
      const Index a = side.facet(f).node[p], b = side.facet(f).node[q];
      const Vec3 e = X[b] - X[a];
      const bool a_decides = place[a] == Place::inner || resolved[b] == Place::ridge;
      const bool b_decides = place[b] == Place::inner || resolved[a] == Place::ridge;
      if (resolved[a] == Place::ridge && resolved[b] == Place::ridge)
        edge_[f][k] = Vec3::Zero();
      else if (a_decides != b_decides)
        edge_[f][k] = a_decides ? arc(normal[a], mirrored(normal[a], e), e)
                                : arc(mirrored(normal[b], e), normal[b], e);
      else
        edge_[f][k] = arc(normal[a], normal[b], e);
    }
}

Vec3 CurvedOffset::at(Index facet, const Vec3& lambda) const {
  Vec3 delta = Vec3::Zero();
  for (int k = 0; k < edges_of_facet(d_); ++k) {
    const auto [a, b] = edge_ends(d_, k);
    delta += lambda[a] * lambda[b] * edge_[facet][k];
  }
  return delta;
}

}  // namespace frictioncg::mortar
