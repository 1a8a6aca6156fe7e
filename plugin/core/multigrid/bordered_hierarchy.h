#pragma once
#include "linear_algebra.h"
#include "multigrid/hierarchy.h"

namespace frictioncg {

/// A hierarchy H of the bodies v, and an exact coarse correction along the motions q of obstacles,
/// whose rows of A are dense. Z (n x k) moves an obstacle by 1, with it what the faces fix to it,
/// and the bodies about as they follow, S = Z'AZ, A being truncated:
///
///   t = S^{-1} Z'r,   y = H (r - AZ t),   z = y + Z (t - S^{-1} (AZ)'y)
///
/// symmetric and definite whatever Z is. Truncations that change much bring Z nearer to how the
/// bodies follow, A Z = 0 on v, by one cycle for each motion.
class BorderedHierarchy final : public Hierarchy {
 public:
  /// bodies: of A without the border of the system, which is kept.
  BorderedHierarchy(const System& system, std::unique_ptr<Hierarchy> bodies);

  void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) override;
  void apply(const Vector& r, Vector& z) override;
  Index levels() const override { return bodies_->levels(); }
  Real operator_complexity() const override { return bodies_->operator_complexity(); }
  double bytes() const override;

 private:
  Index fix(const std::vector<char>& fixed);
  void follow();
  void form(const std::vector<TangentialStiffness>& W, const Vector& springs);
  void cycle(const Vector& r, Vector& y);

  const System& system_;
  const std::unique_ptr<Hierarchy> bodies_;
  const Index first_, border_;  ///< of the dofs q
  std::vector<char> fixed_;     ///< contact dofs
  DenseMatrix Z_, AZ_;          ///< n x k, A not truncated
  DenseMatrix T_, S_;           ///< n x k, k x k, A truncated
  Vector r_v_, z_v_, y_, rest_;
};

/// A without the rows and columns of the border.
Matrix without_border(const System& system);

}  // namespace frictioncg
