#pragma once
#include <array>

#include "model/certificate.h"
#include "model/contact_problem.h"

namespace frictioncg {

/// A matrix as a finite-element code holds it: triplets in any order, Dirichlet rows included.
struct Triplets {
  Index n = 0;
  std::size_t size = 0;
  const Index* i = nullptr;
  const Index* j = nullptr;
  const Real* a = nullptr;
  Index base = 0;     ///< index of the first row: 0 or 1
  bool half = false;  ///< only one triangle is stored
};

/// A node of the boundary that may touch. d = 2 or 3 components are used.
struct ContactPoint {
  std::array<Index, 3> dof{{-1, -1, -1}};  ///< of each component of the displacement
  std::array<Real, 3> normal{{0, 0, 0}};   ///< unit, outward from the body
  bool friction = false;                   ///< has a tangential law
  /// Orthotropic friction in 3D: |(F_1, F_2/across)| <= g, F_1 along this tangent (unit), F_2
  /// across.
  std::array<Real, 3> direction{{0, 0, 0}};
  Real across = 1;  ///< coefficient across over coefficient along, > 0
};

/// The laws of a call, at the contact points.
struct PointLaws {
  Law law = Law::frictionless;
  bool bilateral = false;
  Vector gap;       ///< [length]
  Vector friction;  ///< mu [1] or g [force]; ignored where law is frictionless
};

/// An increment in local frames, and the displacement u0 (n) that it starts from: u = u0 + T x.
struct LocalIncrement {
  Increment increment;
  Vector u0;
};

/// From the assembled system to the contact problem in local frames, and back.
///
/// Dirichlet dofs are recognized by the values in A and eliminated: a huge diagonal (tgv = 1e30) or
/// a row of the identity (tgv = -1, or -2 with homogeneous data). Each contact point gets a frame
/// (n, t) or (n, t1, t2), orthonormal among the components that Dirichlet conditions leave free:
/// the obstacle then sees the projection of its normal. A point without a free normal direction is
/// no contact node. Where the frame is along the axes nothing is rotated.
class LocalSystem {
 public:
  /// Copies A once, in O(nnz); A itself is not kept. mesh_node (n, or empty): which dofs share a
  /// node of the mesh, so that the factorization orders nodes in place of dofs. Throws IllegalInput
  /// for what is not finite, not symmetric, or has a diagonal <= 0.
  LocalSystem(const Triplets& A, int dimension, std::vector<ContactPoint> points,
              const std::vector<Index>& mesh_node = {});

  /// The increment under the load b (n, with the data of Dirichlet dofs as A's storage wants it)
  /// from the state u_old (n, or empty for 0).
  LocalIncrement increment(const Vector& b, const Vector& u_old, const PointLaws& laws) const;

  SystemPtr system() const { return system_; }
  Index nodes() const { return static_cast<Index>(frames_.size()); }
  /// Contact point of contact node k.
  Index point(Index k) const { return frames_[k].point; }
  Index fixed_dofs() const { return static_cast<Index>(fixed_.size()); }
  bool rotated() const { return rotated_; }

  Vector to_local(const Vector& u) const;  ///< free dofs of u (n), in local frames
  /// u0 + x on free dofs, u0 on Dirichlet dofs
  Vector to_global(const Vector& x, const Vector& u0) const;
  Vector force_to_global(const Vector& r) const;  ///< force of the obstacle on the body, -r, (n)

 private:
  /// Orthonormal frame of a contact node, and the lengths of its directions:
  /// u_c = sum_k Q[c][k] x[local[k]]/scale[k] over the free components c.
  struct Frame {
    Index point = 0;                         ///< contact point
    Real share = 1;                          ///< length of the projected normal
    int size = 0;                            ///< free components = directions
    std::array<std::array<Real, 3>, 3> Q{};  ///< columns n, t1, t2
    std::array<Real, 3> scale{{1, 1, 1}};
    std::array<Index, 3> local{{-1, -1, -1}};  ///< local dof of each direction
  };
  struct Fixed {
    Index dof;
    Real diagonal;
    bool alone;  ///< its couplings are not in the matrix
  };
  struct Coupling {
    Index local, fixed;  ///< row of the problem, index into fixed_
    Real a;
  };
  void find_fixed(const Triplets& A);
  void add_frame(Index point);
  void orient(Frame& frame) const;
  void number(Index n);
  void copy(const Triplets& A);
  void merge_duplicates();
  void check_symmetry() const;
  /// Displacements of the script from those of the frames, and forces the other way, take Q/scale;
  /// their inverses take Q scale.
  enum class Direction { from_frame, to_frame };
  template <Direction direction = Direction::from_frame, class Visit>
  void for_each_image(Index dof, Visit visit) const;
  Vector load_to_local(const Vector& b) const;
  Vector dirichlet_data(const Vector& b) const;
  Vector gap_left(const Vector& gap, const Vector& u0) const;

  int d_;
  std::vector<ContactPoint> points_;
  std::shared_ptr<System> system_ = std::make_shared<System>();  ///< const after construction
  std::vector<Frame> frames_;                                    ///< m, one per contact node
  std::vector<Index> image_;     ///< n: local dof, fixed_dof, or in_frame(node, component)
  std::vector<Index> original_;  ///< local dof to a dof of its origin, for messages
  std::vector<Fixed> fixed_;
  std::vector<Coupling> couplings_;
  bool half_ = false;       ///< A was stored by one triangle
  bool unit_rows_ = false;  ///< A has Dirichlet rows of the identity whose columns remain
  bool rotated_ = false;
};

}  // namespace frictioncg
