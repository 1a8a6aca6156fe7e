#include "assembly/frames.h"

#include "linear_algebra.h"

namespace frictioncg {

namespace {

/// A component of a direction below this is taken as 0.
constexpr Real aligned = 1e-14;
/// A normal of which the free components are shorter than this meets no obstacle.
constexpr Real blocked = 1e-6;
/// A normal depends on the others of its node where the sine of its angle to them is below this.
constexpr Real dependent = 1e-3;
/// Two normals are one where the sine of their angle is below this: rounding makes it.
constexpr Real parallel = 1e-12;

Real cleaned(Real component) { return std::abs(component) > aligned ? component : 0; }

/// Finds the frames, numbers the local dofs, and fills the basis.
class Framing {
 public:
  Framing(int dimension, Index n, const std::vector<ContactPoint>& points,
          const Dirichlet& dirichlet)
      : d_(dimension), points_(points), dirichlet_(dirichlet) {
    for (const std::vector<Index>& at : points_by_node(n)) add_frame(at);
    number(n);
    fill(n);
  }
  Frames found() { return {shared_, std::move(nodes_)}; }

 private:
  using Square = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
  /// The frame of a mesh node: rows of to_local are the directions, w = to_local u over its
  /// components; the columns of from_local their dual basis, zero on held components.
  struct Frame {
    std::array<Index, 3> dof{};
    Square to_local, from_local;
    std::vector<ContactNode> nodes;  ///< of its normals, the first directions
    int free = 0;                    ///< directions in all
    bool friction = false;           ///< one normal, and a tangential law
    std::vector<Index> local;        ///< local dof of each direction
  };

  std::vector<std::vector<Index>> points_by_node(Index n) const {
    std::vector<std::vector<Index>> nodes;
    std::vector<Index> node_of(n, -1);
    for (Index p = 0; p < static_cast<Index>(points_.size()); ++p) {
      Index& node = node_of[points_[p].dof[0]];
      if (node < 0) {
        node = static_cast<Index>(nodes.size());
        nodes.emplace_back();
      }
      nodes[node].push_back(p);
    }
    return nodes;
  }
  void add_frame(const std::vector<Index>& points) {
    const std::array<Index, 3>& dof = points_[points.front()].dof;
    Frame f;
    f.dof = dof;
    f.to_local.setZero(d_, d_);
    for (int c = 0; c < d_; ++c) f.free += !dirichlet_.holds(dof[c]);
    for (Index p : points)
      if (add_normal(f, p)) f.friction = points_[p].friction;
    if (f.nodes.empty()) return;
    for (ContactNode& node : f.nodes) node.shared = f.nodes.size() > 1 || !node.rivals.empty();
    f.friction &= !f.nodes.front().shared;
    complete(f);
    frames_.push_back(f);
  }
  /// What Dirichlet conditions leave free of a normal.
  Vec3 free_part(const ContactPoint& p) const {
    Vec3 free = Vec3::Zero();
    for (int c = 0; c < d_; ++c)
      if (!dirichlet_.holds(p.dof[c])) free[c] = cleaned(p.normal[c]);
    return free;
  }
  /// The row of one more normal, unless Dirichlet conditions hold it, or leave it parallel to one
  /// before.
  bool add_normal(Frame& f, Index point) const {
    const ContactPoint& p = points_[point];
    const Vec3 free = free_part(p);
    const Real share = free.norm();
    if (share < blocked) return false;
    if (add_rival(f, point, free)) return false;
    Vec3 rest = free / share;
    const int before = static_cast<int>(f.nodes.size());
    if (before > 0) {  // what it adds to the normals before
      Eigen::Matrix<Real, 3, Eigen::Dynamic, 0, 3, 3> others(3, before);
      for (int k = 0; k < before; ++k) others.col(k) = free_part(points_[f.nodes[k].point]);
      rest -= others * least_squares(others, rest);
    }
    if (before == f.free || rest.norm() < dependent)
      throw ConflictingObstacles(point, "the node of dof " + std::to_string(p.dof[0]),
                                 dependent_normals);
    for (int c = 0; c < d_; ++c) f.to_local(before, c) = cleaned(p.normal[c]);
    f.nodes.push_back({point, false});
    return true;
  }
  /// Along one direction the nearest of several obstacles is felt alone.
  bool add_rival(Frame& f, Index point, const Vec3& free) const {
    for (ContactNode& node : f.nodes) {
      const Vec3 own = free_part(points_[node.point]);
      const Real along = own.dot(free) / own.squaredNorm();
      if (!(along > 0) || (free - along * own).norm() > parallel * free.norm()) continue;
      node.rivals.push_back({point, 1 / along});
      return true;
    }
    return false;
  }
  /// Tangents: Gram-Schmidt on the axes, that least along the normals first; then the dual basis.
  void complete(Frame& f) const {
    const int normals = static_cast<int>(f.nodes.size());
    Square orthonormal = on_free_components(f);
    const auto orthogonalize = [&](int k) {
      for (int q = 0; q < k; ++q)
        orthonormal.row(k) -= orthonormal.row(k).dot(orthonormal.row(q)) * orthonormal.row(q);
      orthonormal.row(k).normalize();
    };
    for (int k = 0; k < normals; ++k) orthogonalize(k);
    std::array<bool, 3> used{};
    for (int k = normals; k < f.free; ++k) {
      int axis = -1;
      Real least = 0;
      for (int c = 0; c < d_; ++c) {
        if (dirichlet_.holds(f.dof[c]) || used[c]) continue;
        const Real along = orthonormal.col(c).head(normals).norm();
        if (axis < 0 || along < least) axis = c, least = along;
      }
      used[axis] = true;
      orthonormal.row(k).setZero();
      orthonormal(k, axis) = 1;
      orthogonalize(k);
      f.to_local.row(k) = orthonormal.row(k);
    }
    orient(f);
    dualize(f);
  }
  /// The directions on what Dirichlet conditions leave free.
  Square on_free_components(const Frame& f) const {
    Square free = f.to_local;
    for (int c = 0; c < d_; ++c)
      if (dirichlet_.holds(f.dof[c])) free.col(c).setZero();
    return free;
  }
  /// from_local: the inverse of the directions on the free components.
  void dualize(Frame& f) const {
    const Square free = on_free_components(f);
    f.from_local.setZero(d_, d_);
    if (f.nodes.size() == 1) {  // orthogonal rows: exact where they lie along the axes
      for (int k = 0; k < f.free; ++k)
        f.from_local.col(k) = free.row(k).transpose() / free.row(k).squaredNorm();
    } else {
      f.from_local.leftCols(f.free) =
          least_squares(free.topRows(f.free), DenseMatrix::Identity(f.free, f.free));
    }
  }
  /// Turns the tangents to the principal directions of orthotropic friction, and scales them. Where
  /// Dirichlet conditions leave one tangent t, the dissipation along it decides: g |(t_1, across
  /// t_2)|.
  void orient(Frame& f) const {
    const ContactPoint& p = points_[f.nodes.front().point];
    if (p.mu_ratio == 1 || f.free < 2 || f.nodes.size() > 1) return;
    const Vec3 along = (p.direction - p.normal * p.normal.dot(p.direction)).normalized();
    const Vec3 across = p.normal.cross(along);
    if (f.free == 3) {
      f.to_local.row(1) = along.unaryExpr(&cleaned).transpose();
      f.to_local.row(2) = p.mu_ratio * across.unaryExpr(&cleaned).transpose();
    } else {
      const Vec3 t = f.to_local.row(1).transpose();
      f.to_local.row(1) *= std::hypot(t.dot(along), p.mu_ratio * t.dot(across));
    }
  }
  /// Local dofs: the interior in its order, directions without a law, then node by node.
  void number(Index n) {
    std::vector<char> framed(n, 0);
    for (const Frame& f : frames_)
      for (int c = 0; c < d_; ++c) framed[f.dof[c]] = 1;
    basis_.origin.reserve(n);
    const auto next = [this](Index dof) {
      basis_.origin.push_back(dof);
      return basis_.local_dofs() - 1;
    };
    for (Index i = 0; i < n; ++i)
      if (!framed[i] && !dirichlet_.holds(i)) next(i);
    unframed_ = basis_.local_dofs();
    for (Frame& f : frames_) {
      f.local.assign(f.free, -1);
      for (int k = static_cast<int>(f.nodes.size()); k < f.free && !f.friction; ++k)
        f.local[k] = next(f.dof[0]);
    }
    for (Frame& f : frames_)
      for (int k = 0; k < f.free; ++k) {
        const bool starts_node = k < static_cast<int>(f.nodes.size());
        if (starts_node) {
          basis_.first.push_back(basis_.local_dofs());
          nodes_.push_back(f.nodes[k]);
        }
        if (f.local[k] < 0) f.local[k] = next(f.dof[0]);
      }
    basis_.first.push_back(basis_.local_dofs());
  }
  void fill(Index n) {
    const Index w = basis_.local_dofs();
    EntryList T, W;
    for (Index p = 0; p < unframed_; ++p) {
      T.emplace_back(basis_.origin[p], p, 1);
      W.emplace_back(p, basis_.origin[p], 1);
    }
    for (Index k = 0; k < dirichlet_.size(); ++k) T.emplace_back(dirichlet_.dof(k), w + k, 1);
    for (const Frame& f : frames_)
      for (int c = 0; c < d_; ++c) {
        const bool held = dirichlet_.holds(f.dof[c]);
        int entries = 0;
        for (int k = 0; k < f.free; ++k) {
          if (f.to_local(k, c) != 0) W.emplace_back(f.local[k], f.dof[c], f.to_local(k, c));
          if (held || f.from_local(c, k) == 0) continue;
          T.emplace_back(f.dof[c], f.local[k], f.from_local(c, k));
          ++entries;
          for (int h = 0; h < d_; ++h)  // u = from_local (w - what is prescribed of it)
            if (dirichlet_.holds(f.dof[h]) && f.to_local(k, h) != 0)
              T.emplace_back(f.dof[c], w + dirichlet_.number(f.dof[h]),
                             -f.from_local(c, k) * f.to_local(k, h));
        }
        basis_.rotated |= entries > 1;
      }
    basis_.T = sparse(n, w + dirichlet_.size(), T);
    basis_.W = sparse(w, n, W);
  }

  const int d_;
  const std::vector<ContactPoint>& points_;
  const Dirichlet& dirichlet_;
  std::vector<Frame> frames_;
  std::vector<ContactNode> nodes_;
  Index unframed_ = 0;  ///< local dofs that are dofs of the script
  std::shared_ptr<Basis> shared_ = std::make_shared<Basis>();  // Eigen's matrices do not move
  Basis& basis_ = *shared_;
};

}  // namespace

Frames frames_at(int dimension, Index n, const std::vector<ContactPoint>& points,
                 const Dirichlet& dirichlet) {
  return Framing(dimension, n, points, dirichlet).found();
}

}  // namespace frictioncg
