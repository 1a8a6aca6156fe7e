#pragma once
#include "assembly/triplets.h"
#include "types.h"

namespace frictioncg {

/// A point of the boundary that may touch, with one normal. d = 2 or 3 components are used. A node
/// in a corner has several points: the same dofs, linearly independent normals.
struct ContactPoint {
  std::array<Index, 3> dof{{-1, -1, -1}};  ///< of each component of the displacement
  Vec3 normal = Vec3::Zero();              ///< unit, outward from the body
  bool friction = false;                   ///< has a tangential law
  /// Orthotropic friction in 3D: |(F_1, F_2/across)| <= g, F_1 along this tangent (unit), F_2
  /// across.
  Vec3 direction = Vec3::Zero();
  Real mu_ratio = 1;  ///< coefficient across over coefficient along, > 0
};

/// The dofs at nodes of the mesh, one of each component of the displacement; -1: none.
using NodeDofs = std::vector<std::array<Index, 3>>;

NodeDofs dofs_of(const std::vector<ContactPoint>& points);

/// The dofs that Dirichlet conditions hold, recognized by the values in A (the flags that come with
/// FreeFEM's matrices do not survive their copies): a huge diagonal (tgv = 1e30), or a row of the
/// identity (tgv = -1, or -2 with homogeneous data).
class Dirichlet {
 public:
  /// Throws IllegalInput for entries that are not finite and for diagonals <= 0. A row that is
  /// alone in the matrix counts as held, unless it may touch and is none of the identity: then it
  /// is a spring.
  Dirichlet(const Triplets& A, const NodeDofs& may_touch);

  /// The same where further dofs follow those of A, of which others know what holds them.   held,
  /// diagonal: of all dofs
  Dirichlet with_more(const std::vector<char>& held, const Vector& diagonal) const;

  Index size() const { return static_cast<Index>(held_.size()); }
  Index dof(Index k) const { return held_[k].dof; }
  /// Number of a held dof, or -1 for a free one.
  Index number(Index dof) const { return number_[dof]; }
  bool holds(Index dof) const { return number_[dof] >= 0; }
  /// Whether some rows are those of the identity, their columns as they were: tgv = -1.
  bool has_unit_rows() const { return unit_rows_; }

  /// The prescribed displacements (size()) in the load b (n). Throws IllegalInput where A does not
  /// have the couplings that they need.
  Vector data(const Vector& b) const;

 private:
  struct Held {
    Index dof;
    Real diagonal;
    bool uncoupled;  ///< its couplings are not in the matrix, and no other process judges
    bool lost;       ///< uncoupled, and free dofs beside it show that there were some
  };
  void find_lost(const Triplets& A);
  std::vector<Held> held_;
  std::vector<Index> number_;
  bool half_ = false;  ///< A was stored by one triangle
  bool unit_rows_ = false;
};

}  // namespace frictioncg
