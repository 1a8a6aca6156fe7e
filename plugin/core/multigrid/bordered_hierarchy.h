#pragma once
#include "multigrid/hierarchy.h"

namespace frictioncg {

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
  BorderedHierarchy(const System& system, std::unique_ptr<LevelHierarchy> bodies);

  void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) override;
  void apply(const Vector& r, Vector& z) override;
  Index levels() const override { return bodies_->levels(); }
  Real operator_complexity() const override { return bodies_->operator_complexity(); }
  double bytes() const override;

 private:
  Border border(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) const;

  const System& system_;
  const std::unique_ptr<LevelHierarchy> bodies_;
  const Index first_, border_;    ///< of the dofs q
  const DenseMatrix at_contact_;  ///< contact_dofs x k, of the system's border
  std::vector<Index> near_;       ///< the contact dofs and those beside them, without q
  std::vector<Index> place_;      ///< n, in near_, or -1
  Matrix Z_;
  Vector r_, z_;  ///< of (v, q)
};

/// A without the rows and columns of the border.
Matrix without_border(const System& system);

}  // namespace frictioncg
