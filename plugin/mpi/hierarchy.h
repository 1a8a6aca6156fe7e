#pragma once
#include "multigrid/hierarchy.h"
#include "levels.h"

namespace frictioncg {

/// Smoothed aggregation of PETSc's (GAMG) for A of all processes, and its cycle (PCMG) with the
/// contact faces cut out on every level:
///
///   fine level     M A M + W, with the diagonal of A on fixed dofs
///   coarse levels  A_1 + P_0'(M B M - B + W) P_0,  A_2 + P_1' dA_1 P_1, ...
///
/// B: entries of A in rows or columns of contact dofs; M drops the fixed ones. P and A_1, A_2 come
/// from A, once. The coarse levels see M P_0; on the fine one, rows of fixed dofs are uncoupled,
/// and what they carry is dropped before and after the cycle.
class SharedHierarchy final : public Hierarchy {
 public:
  /// modes: rigid motions of the own dofs (own x k), the same combinations on all processes.
  /// Collective.
  SharedHierarchy(std::shared_ptr<const SharedMatrix> A, const Eigen::MatrixXd& modes,
                  Coarsening coarsening);

  void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) override;
  void apply(const Vector& r, Vector& z) override;
  Index levels() const override { return static_cast<Index>(level_.size()); }
  Real operator_complexity() const override;

 private:
  void fill_contact_part(const std::vector<TangentialStiffness>& W, const Vector& springs);
  void truncate_levels();
  void fill_empty_rows(const Level& level);
  void set_mask(const std::vector<char>& fixed);

  std::shared_ptr<const SharedMatrix> A_;
  std::vector<Level> level_;  ///< from the finest to the coarsest
  PCHandle cycle_;
  bool settled_ = false;
  MatHandle E_;              ///< M B M - B + W
  VecHandle mask_;           ///< 0 on fixed dofs, else 1
  std::vector<char> fixed_;  ///< own contact dofs
  Vector free_;              ///< r without that of fixed dofs
  VecHandle r_, z_;
};

}  // namespace frictioncg
