#pragma once
// Scenes for the tests: P1 elasticity on a block of simplices, assembled here, without FreeFEM.
#include <Eigen/Geometry>

#include <random>

#include "core/assembly/local_system.h"

namespace frictioncg::test {

/// A system of these tests, to be copied and changed.
inline const AssembledSystem& assembled(const SystemPtr& system) {
  return dynamic_cast<const AssembledSystem&>(*system);
}

/// |x_T| at contact node i.
inline Real tangential_norm(const System& s, Index i, const Vector& x) {
  return x.segment(s.first[i] + 1, s.tangents(i)).norm();
}

/// A scene in local frames, and the way back.
class Posed {
 public:
  Posed(std::unique_ptr<const LocalSystem> local, const Vector& b, const Vector& u_old,
        const PointLaws& laws)
      : local_(std::move(local)) {
    pose(b, u_old, laws);
  }
  void pose(const Vector& b, const Vector& u_old, const PointLaws& laws) {
    LocalIncrement now = local_->increment(b, u_old, laws);
    u0_ = now.u0;
    problem_ = {local_->system(), now.increment};
  }
  const ContactProblem& problem() const { return problem_; }
  const LocalSystem& local() const { return *local_; }
  Index nodes() const { return local_->nodes(); }
  bool rotated() const { return local_->rotated(); }
  Index fixed_dofs() const { return local_->fixed_dofs(); }
  Vector to_local(const Vector& u) const { return local_->to_local(u); }
  Vector to_global(const Vector& x) const { return local_->to_global(x, u0_); }
  Vector force_to_global(const Vector& r) const { return local_->force_to_global(r); }

 private:
  std::unique_ptr<const LocalSystem> local_;
  Vector u0_;
  ContactProblem problem_;
};

/// An assembled scene in global components, the way a script would hand it over.
struct Scene {
  int d = 2;
  Index n = 0;
  std::vector<Index> i, j;
  std::vector<Real> a;
  Vector b, gap, friction, u_old;  // u_old empty: 0
  Vector cohesion, cap;            // coulomb; empty: none
  std::vector<ContactPoint> points;
  Law law = Law::coulomb;
  Eigen::MatrixXd modes;  // n x k, rigid motions; 0 columns: not known

  Triplets triplets() const { return {n, a.size(), i.data(), j.data(), a.data(), 0, false}; }
  PointLaws laws() const {
    if (law == Law::tresca) return {law, false, gap, {}, friction};
    return {law, false, gap, friction, {}, cohesion, cap};
  }
  Posed system(const std::vector<Index>& mesh_node = {}) const;
  Real& entry(Index row, Index column);  ///< one that is stored
};

/// Which mesh node each dof belongs to.
inline std::vector<Index> mesh_nodes(const Scene& s) {
  std::vector<Index> node(s.n);
  for (Index i = 0; i < s.n; ++i) node[i] = i / s.d;
  return node;
}

/// The rigid motions of nodes at X (nodes x 3), whose components are numbered node by node.
Eigen::MatrixXd rigid_motions_of(const Eigen::MatrixXd& X, int d);

struct BlockOptions {
  int d = 2;
  int cells = 4;  // per edge
  Real E = 1000, nu = 0.3;
  Real size = 1;
  Real mu = 0.3;
  Law law = Law::coulomb;  // tresca: mu is then the limit per node
  Real pressure = 10, shear = 2;
  bool clamp_side = false;  // u_x = 0 on the face x = size; without it contact alone holds the body
  Real angle = 0;           // rotates the whole scene about the axis (2D: z)
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  Real distortion = 0;  // random displacement of interior mesh nodes, in cells
  unsigned seed = 1;
  bool tgv_minus_one = false;
};

/// Of a small block that is held at its side, and sheared twice as much as usual.
BlockOptions sheared_at_side(int d, Law law = Law::coulomb);

/// A block [0,size]^d pressed by a face load on its top on a rigid plane at its bottom, sheared
/// along x.
Scene block(const BlockOptions& o);

}  // namespace frictioncg::test
