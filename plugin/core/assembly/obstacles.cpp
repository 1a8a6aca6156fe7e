#include "assembly/obstacles.h"

#include "assembly/slippable.h"

namespace frictioncg {

namespace {

/// A component moves no node where it moves each by less than this share of its unit.
constexpr Real nothing = 1e-12;

/// The extents of the contact points of each obstacle; 1 for a single one.
std::vector<Real> extents(const RigidObstacles& obstacles, Index count) {
  std::vector<Eigen::AlignedBox3d> box(count);
  for (std::size_t p = 0; p < obstacles.arm.size(); ++p)
    if (const Index o = obstacles.of_point[p]; o >= 0) box[o].extend(obstacles.arm[p]);
  std::vector<Real> extent(count, 1);
  for (Index o = 0; o < count; ++o)
    if (!box[o].isEmpty() && box[o].min() != box[o].max()) extent[o] = box[o].sizes().norm() / 2;
  return extent;
}

/// Of each local dof, the contact point that it belongs to, or -1.
std::vector<Index> points_of_dofs(const Basis& basis, const std::vector<ContactPoint>& points,
                                  const std::vector<ContactNode>& nodes) {
  std::vector<Index> point_of(basis.local_dofs(), -1);
  std::vector<Index> at(basis.T.rows(), -1);  // of a mesh node's first dof: a point there
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Index point = nodes[k].point;
    Index& first = at[points[point].dof[0]];
    if (first < 0) first = point;
    for (Index p = basis.first[k]; p < basis.first[k + 1]; ++p) point_of[p] = point;
  }
  // directions without a law go along: else nothing would bar an obstacle's slip
  for (Index p = 0; p < basis.first.front(); ++p) point_of[p] = at[basis.origin[p]];
  return point_of;
}

/// C = W B: the displacement of the obstacles in local dofs.   columns x n_q, 0 from row n_w on
Matrix displacements(const Basis& basis, int d, const std::vector<ContactPoint>& points,
                     const std::vector<ContactNode>& nodes, const RigidObstacles& obstacles) {
  const std::vector<Index> point_of = points_of_dofs(basis, points, nodes);
  const RigidGenerators generators(d, Vec3::Zero(), 1);
  const Index each = generators.count();
  EntryList entries;
  for (Index p = 0; p < basis.local_dofs(); ++p) {
    const Index point = point_of[p];
    const Index o = point < 0 ? -1 : obstacles.of_point[point];
    if (o < 0) continue;
    const auto B = generators.at(obstacles.arm[point]);
    for (Index k = 0; k < each; ++k) {
      Real moved = 0;
      for (Matrix::InnerIterator w(basis.W, p); w; ++w)
        for (int c = 0; c < d; ++c)
          if (points[point].dof[c] == w.col()) moved += w.value() * B(c, k);
      if (moved != 0) entries.emplace_back(p, o * each + k, moved);
    }
  }
  return sparse(basis.T.cols(), obstacles.dofs(), entries);
}

/// The nearest of several obstacles along one direction would change as one of them moves.
void refuse_rivals(const std::vector<ContactPoint>& points, const std::vector<ContactNode>& nodes,
                   const RigidObstacles& obstacles) {
  for (const ContactNode& node : nodes)
    for (const Rival& r : node.rivals)
      if (obstacles.of_point[node.point] >= 0 || obstacles.of_point[r.point] >= 0)
        throw ConflictingObstacles(
            r.point, "the node of dof " + std::to_string(points[r.point].dof[0]), moving_rivals);
}

void refuse_useless(const Matrix& C, const Vector& unit, const RigidObstacles& obstacles) {
  Vector most = Vector::Zero(C.cols());
  for (Index p = 0; p < C.rows(); ++p)
    for (Matrix::InnerIterator c(C, p); c; ++c)
      most[c.col()] = std::max(most[c.col()], std::abs(c.value()) / unit[c.col()]);
  for (Index k = 0; k < C.cols(); ++k)
    if (obstacles.free[k] && !(most[k] > nothing)) throw UselessComponent(k);
}

}  // namespace

Basis with_obstacles(const Basis& standing, int d, const std::vector<ContactPoint>& points,
                     const std::vector<ContactNode>& nodes, const RigidObstacles& obstacles) {
  refuse_rivals(points, nodes, obstacles);
  const Index each = rigid_components(d), n = static_cast<Index>(standing.T.rows());
  const Index w = standing.local_dofs(), n_q = obstacles.dofs(), interior = standing.first.front();
  const std::vector<Real> extent = extents(obstacles, n_q / each);
  Vector unit = Vector::Ones(n_q);  // a free component's local dof over itself
  for (Index k = 0; k < n_q; ++k)
    if (k % each >= d) unit[k] = extent[k / each];
  const Matrix C = displacements(standing, d, points, nodes, obstacles);
  refuse_useless(C, unit, obstacles);

  const Index free =
      n_q - static_cast<Index>(std::count(obstacles.free.begin(), obstacles.free.end(), 0));
  std::vector<Index> column(n_q);  // of T
  for (Index k = 0, f = interior, h = static_cast<Index>(standing.T.cols()) + free; k < n_q; ++k)
    column[k] = obstacles.free[k] ? f++ : h++;
  const auto scale = [&](Index k) { return obstacles.free[k] ? unit[k] : 1; };

  Basis moving;
  moving.rotated = true;
  moving.origin = standing.origin;
  std::vector<Index> of_q;
  for (Index k = 0; k < n_q; ++k)
    if (obstacles.free[k]) of_q.push_back(n + k);
  moving.origin.insert(moving.origin.begin() + interior, of_q.begin(), of_q.end());
  for (Index first : standing.first) moving.first.push_back(first + free);

  // u = T_w (w + C q) + T_D u_D
  EntryList T, W;
  const auto place = [&](Index p) { return p < interior ? p : p + free; };
  const Matrix TC = standing.T * C;
  for (Index i = 0; i < n; ++i) {
    for (Matrix::InnerIterator e(standing.T, i); e; ++e)
      T.emplace_back(i, place(static_cast<Index>(e.col())), e.value());
    for (Matrix::InnerIterator e(TC, i); e; ++e)
      T.emplace_back(i, column[e.col()], e.value() / scale(static_cast<Index>(e.col())));
  }
  for (Index k = 0; k < n_q; ++k) T.emplace_back(n + k, column[k], 1 / scale(k));
  moving.T = sparse(n + n_q, static_cast<Index>(standing.T.cols()) + n_q, T);

  // w = W u - C q
  for (Index p = 0; p < w; ++p) {
    for (Matrix::InnerIterator e(standing.W, p); e; ++e)
      W.emplace_back(place(p), e.col(), e.value());
    for (Matrix::InnerIterator e(C, p); e; ++e) W.emplace_back(place(p), n + e.col(), -e.value());
  }
  for (Index k = 0; k < n_q; ++k)
    if (obstacles.free[k]) W.emplace_back(column[k], n + k, unit[k]);
  moving.W = sparse(w + free, n + n_q, W);
  return moving;
}

Matrix with_obstacles(const Matrix& modes, Index n_q) {
  const Index n = static_cast<Index>(modes.rows()), k = static_cast<Index>(modes.cols());
  Matrix all;
  all = modes;
  all.conservativeResize(n + n_q, k + n_q);
  for (Index q = 0; q < n_q; ++q) all.insert(n + q, k + q) = 1;
  all.makeCompressed();
  return all;
}

}  // namespace frictioncg
