#include "multigrid/hierarchy.h"

namespace frictioncg {

namespace {

/// S gets this share of the border's D in addition: an obstacle that no face holds makes it
/// singular, and one that a single node holds is softer than D by their number.
constexpr Real border_shift = 1e-10;

/// A hierarchy of the bodies v that carries the motions q of obstacles, whose rows of A are dense,
/// on every level. Z (n x k) moves an obstacle by 1, with it what the faces fix to it, and nothing
/// else; in x = v + Z q the truncated A is
///
///   [A_v  B ]      B = (A Z)_v,  S = Z'A Z,
///   [B'   S ]
///
/// B has rows at the contact nodes and beside them alone, and aggregates move with an obstacle as
/// rigidly as with the ground.
class BorderedHierarchy final : public Hierarchy {
 public:
  /// bodies: of A without the border of the system, which is kept.
  BorderedHierarchy(const System& system, std::unique_ptr<Hierarchy> bodies)
      : system_(system),
        bodies_(std::move(bodies)),
        first_(system.interior() - static_cast<Index>(system.border.cols())),
        border_(static_cast<Index>(system.border.cols())),
        at_contact_(DenseMatrix(system.border).bottomRows(system.contact_dofs())),
        place_(system.dofs(), -1),
        Z_(system.border),
        r_(system.dofs()),
        z_(system.dofs()) {
    for (Index p = system.interior(); p < system.dofs(); ++p)
      for (Matrix::InnerIterator a(system.entries(), p); a; ++a) {
        const Index i = static_cast<Index>(a.col());
        if (place_[i] >= 0 || (i >= first_ && i < first_ + border_)) continue;
        place_[i] = static_cast<Index>(near_.size());
        near_.push_back(i);
      }
  }

  void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) override {
    Z_ = system_.border;
    Z_.prune([&](Index p, Index, Real) {
      return p < system_.interior() || !fixed[p - system_.interior()];
    });
    Border of_bodies = border(fixed, W, springs);
    for (Index& p : of_bodies.row)
      if (p >= first_) p -= border_;
    std::vector<TangentialStiffness> W_of_bodies = W;
    for (TangentialStiffness& w : W_of_bodies) w.first -= border_;
    bodies_->join(of_bodies);
    bodies_->truncate(fixed, W_of_bodies, springs);
  }

  void apply(const Vector& r, Vector& z) override {
    const Index behind = static_cast<Index>(r.size()) - first_ - border_;
    r_.head(first_) = r.head(first_);
    r_.segment(first_, behind) = r.tail(behind);
    r_.tail(border_).noalias() = Z_.transpose() * r;
    bodies_->apply(r_, z_);
    z.noalias() = Z_ * z_.tail(border_);
    z.head(first_) += z_.head(first_);
    z.tail(behind) += z_.segment(first_, behind);
  }

  Index levels() const override { return bodies_->levels(); }
  Real operator_complexity() const override { return bodies_->operator_complexity(); }
  double bytes() const override {
    return bodies_->bytes() + (sizeof(Real) + sizeof(Index)) * double(Z_.nonZeros()) +
           sizeof(Real) * double(at_contact_.size()) +
           sizeof(Index) * double(near_.size() + place_.size());
  }

 private:
  /// B and S. Z is the border without what is fixed, Y, and A border = 0:
  ///   A Z = -A Y,  Z'A Z = Y'A Y
  Border border(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) const {
    const Index contact = static_cast<Index>(fixed.size()), interior = system_.interior();
    DenseMatrix B = DenseMatrix::Zero(near_.size(), border_);
    DenseMatrix S = border_shift * DenseMatrix(system_.D.segment(first_, border_).asDiagonal());
    for (Index c = 0; c < contact; ++c) {
      if (!fixed[c]) continue;
      for (Matrix::InnerIterator a(system_.entries(), interior + c); a; ++a)
        if (place_[a.col()] >= 0) B.row(place_[a.col()]) -= a.value() * at_contact_.row(c);
    }
    for (Index c = 0; c < contact; ++c) {
      const Index p = place_[interior + c];
      if (fixed[c]) {
        S -= at_contact_.row(c).transpose() * B.row(p);
        B.row(p).setZero();
      } else if (springs.size() > 0) {
        B.row(p) += springs[c] * at_contact_.row(c);
        S += springs[c] * at_contact_.row(c).transpose() * at_contact_.row(c);
      }
    }
    for (const TangentialStiffness& w : W) {
      const DenseMatrix Z = at_contact_.middleRows(w.first - interior, 2), MZ = w.M * Z;
      for (Index t = 0; t < 2; ++t) B.row(place_[w.first + t]) += MZ.row(t);
      S += Z.transpose() * MZ;
    }
    return {near_, B, S};
  }

  const System& system_;
  const std::unique_ptr<Hierarchy> bodies_;
  const Index first_, border_;    ///< of the dofs q
  const DenseMatrix at_contact_;  ///< contact_dofs x k, of the system's border
  std::vector<Index> near_;       ///< the contact dofs and those beside them, without q
  std::vector<Index> place_;      ///< n, in near_, or -1
  Matrix Z_;
  Vector r_, z_;  ///< of (v, q)
};

/// A without the rows and columns of the border.
Matrix without_border(const System& system) {
  const Index k = static_cast<Index>(system.border.cols()), n = system.dofs();
  const Index end = system.interior(), first = end - k;
  Matrix A(n - k, n - k);
  A.reserve(system.entries().nonZeros());
  for (Index p = 0; p < n; ++p) {
    if (p >= first && p < end) continue;
    const Index row = p < first ? p : p - k;
    A.startVec(row);
    for (Matrix::InnerIterator e(system.entries(), p); e; ++e)
      if (e.col() < first || e.col() >= end)
        A.insertBack(row, e.col() < first ? e.col() : e.col() - k) = e.value();
  }
  A.finalize();
  return A;
}

/// Whether no mesh node has more dofs than the dimension: what is more is no displacement.
bool are_displacements(const System& system) {
  std::vector<int> count;
  for (const Index node : system.mesh_node) {
    if (node >= static_cast<Index>(count.size())) count.resize(node + 1, 0);
    if (++count[node] > system.dimension) return false;
  }
  return !system.mesh_node.empty();
}

}  // namespace

std::unique_ptr<Hierarchy> make_hierarchy(const System& system, const HierarchyOptions& options) {
  if (!system.rigid_modes || !are_displacements(system)) return nullptr;
  Eigen::MatrixXd modes = system.rigid_modes();
  if (modes.rows() != system.dofs() || modes.cols() != rigid_components(system.dimension))
    return nullptr;
  const Index k = static_cast<Index>(system.border.cols()), end = system.interior();
  if (k == 0 || system.dofs() <= options.dense) {
    const NodeBlocks blocks =
        make_node_blocks(system.entries(), system.mesh_node, modes, system.dimension, end);
    return make_hierarchy(system.entries(), blocks, modes, options);
  }
  std::vector<Index> mesh_node = system.mesh_node;
  mesh_node.erase(mesh_node.begin() + end - k, mesh_node.begin() + end);
  Eigen::MatrixXd of_bodies(system.dofs() - k, modes.cols());
  of_bodies << modes.topRows(end - k), modes.bottomRows(system.contact_dofs());
  const Matrix A = without_border(system);
  const NodeBlocks blocks = make_node_blocks(A, mesh_node, of_bodies, system.dimension, end - k);
  HierarchyOptions within = options;
  within.multiplies = false;  // by the whole of A alone
  within.dense = 0;           // levels join a border
  return std::make_unique<BorderedHierarchy>(system, make_hierarchy(A, blocks, of_bodies, within));
}

}  // namespace frictioncg
