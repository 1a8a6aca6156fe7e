#include "assembly/mortar/curvature.h"

#include <algorithm>
#include <cmath>

#include "assembly/mortar/smooth_side.h"

namespace frictioncg::mortar {

namespace {

/// A joint that turns so many times as much as the joints beside it is a kink between straight
/// flanks, and no part of an arc.
constexpr Real kink = 4;

/// Tells of each joint whether the surface goes on over it. It does not over the edges of the body,
/// and in 2D not over a kink between straight flanks, where it does not go on turning.
std::vector<char> smooth_joints(const Side& side) {
  std::vector<char> smooth = joints_that_go_on(side);
  if (side.d == 3) return smooth;
  std::vector<Real> turn;
  std::vector<std::array<Index, 2>> of_facet(side.facets(), {-1, -1});
  for (std::size_t k = 0; k < side.joints.size(); ++k) {
    turn.push_back(std::acos(std::clamp(side.joints[k].cosine, -1.0, 1.0)));
    for (Index f : side.joints[k].facet)
      of_facet[f][of_facet[f][0] < 0 ? 0 : 1] = static_cast<Index>(k);
  }
  for (std::size_t k = 0; k < side.joints.size(); ++k) {
    if (side.joints[k].cosine >= one_surface) continue;
    Real beside = 0;
    for (Index f : side.joints[k].facet)
      for (Index other : of_facet[f])
        if (other >= 0 && other != static_cast<Index>(k)) beside = std::max(beside, turn[other]);
    if (turn[k] > kink * beside) smooth[k] = false;
  }
  return smooth;
}

/// q (n_a + n_b) / (1 + n_a.n_b)
Vec3 arc(const Vec3& n_a, const Vec3& n_b, const Vec3& e) {
  const Real cosine = n_a.dot(n_b);
  if (cosine < 0) return Vec3::Zero();
  return (n_b - n_a).dot(e) / 2 / (1 + cosine) * (n_a + n_b);
}

}  // namespace

CurvedOffset::CurvedOffset(const Side& side, const std::vector<Vec3>& X)
    : edge_(side.facets()), d_(side.d) {
  const SmoothSide smooth(side, X, smooth_joints(side));
  for (Index f = 0; f < side.facets(); ++f)
    for (int k = 0; k < edges_of_facet(d_); ++k) {
      const auto [p, q] = edge_ends(d_, k);
      const Vec3 e = X[side.facet(f).node[q]] - X[side.facet(f).node[p]];
      edge_[f][k] = arc(smooth.at(f, p).normal, smooth.at(f, q).normal, e);
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
