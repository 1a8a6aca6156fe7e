#include "assembly/mortar/search.h"

namespace frictioncg::mortar {

namespace {

/// A leaf of the tree holds at most so many facets.
constexpr Index leaf_size = 4;
/// Unit normals whose sum is shorter than this point in all directions: the sum has no axis.
constexpr Real no_axis = 1e-6;
/// The angles that bound a cosine are rounded: a facet is passed over only beyond this margin.
constexpr Real cosine_margin = 1e-9;

Real angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

FacetTree::FacetTree(int d, const std::vector<Facet>& facets, const std::vector<Plane>& planes,
                     const std::vector<Vec3>& X)
    : planes_(planes), boxes_(facets.size()), order_(facets.size()) {
  for (std::size_t f = 0; f < facets.size(); ++f)
    for (int v = 0; v < d; ++v) boxes_[f].extend(X[facets[f].node[v]]);
  std::iota(order_.begin(), order_.end(), 0);
  if (!facets.empty()) build(0, static_cast<Index>(facets.size()));
}

/// Halves at the median along the longest side.
Index FacetTree::build(Index begin, Index end) {
  const Index self = static_cast<Index>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.begin = begin;
  node.end = end;
  bound(node);
  if (end - begin > leaf_size) {
    int side;
    node.box.sizes().maxCoeff(&side);
    const Index middle = begin + (end - begin) / 2;
    std::nth_element(
        order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
        [&](Index a, Index b) { return boxes_[a].center()[side] < boxes_[b].center()[side]; });
    node.left = build(begin, middle);
    node.right = build(middle, end);
  }
  nodes_[self] = node;
  return self;
}

void FacetTree::bound(Node& node) const {
  Vec3 sum = Vec3::Zero();
  for (Index k = node.begin; k < node.end; ++k) {
    node.box.extend(boxes_[order_[k]]);
    sum += planes_[order_[k]].normal;
  }
  node.angle = M_PI;  // every direction
  if (sum.norm() < no_axis) return;
  node.axis = sum.normalized();
  Real angle = 0;
  for (Index k = node.begin; k < node.end; ++k)
    angle = std::max(angle, angle_between(node.axis, planes_[order_[k]].normal));
  node.angle = angle;
}

/// Separating axes: the normal of the base, and the gradients of its barycentric coordinates.
bool FacetTree::may_meet(const Node& node, const Column& column) const {
  const Plane& base = column.base;
  if (column.only_facing && node.angle < M_PI) {
    const Real most = std::min(M_PI, angle_between(node.axis, base.normal) + node.angle);
    if (std::cos(most) > facing + cosine_margin) return false;
  }
  const Vec3 centre = node.box.center() - base.origin, half = node.box.sizes() / 2;
  const auto outside = [&](const Vec3& axis, Real low, Real high) {
    const Real middle = axis.dot(centre), reach = axis.cwiseAbs().dot(half);
    return middle + reach < low || middle - reach > high;
  };
  const Vec3 b1 = base.B.row(0).transpose(), b2 = base.B.row(1).transpose();
  return !outside(base.normal, column.behind, column.ahead) && !outside(b1, 0, 1) &&
         !outside(b2, 0, 1) && !outside(b1 + b2, 0, 1);
}

void FacetTree::find(const Column& column, std::vector<Index>& found) const {
  found.clear();
  std::vector<Index> stack;
  if (!nodes_.empty()) stack.push_back(0);
  while (!stack.empty()) {
    const Node& node = nodes_[stack.back()];
    stack.pop_back();
    ++visited_;
    if (!may_meet(node, column)) continue;
    if (node.left >= 0) {
      stack.push_back(node.left);
      stack.push_back(node.right);
      continue;
    }
    for (Index k = node.begin; k < node.end; ++k)
      if (!column.only_facing || planes_[order_[k]].normal.dot(column.base.normal) < facing)
        found.push_back(order_[k]);
  }
}

Real FacetTree::nearest(const Vec3& x) const {
  Real best = infinity;
  std::vector<Index> stack;
  if (!nodes_.empty()) stack.push_back(0);
  while (!stack.empty()) {
    const Node& node = nodes_[stack.back()];
    stack.pop_back();
    if (node.box.exteriorDistance(x) >= best) continue;
    if (node.left < 0)
      for (Index k = node.begin; k < node.end; ++k)
        best = std::min(best, boxes_[order_[k]].exteriorDistance(x));
    else {
      stack.push_back(node.right);
      stack.push_back(node.left);
    }
  }
  return best;
}

}  // namespace frictioncg::mortar
