#pragma once
#include <memory>

#include "gradient/residual_preconditioner.h"
#include "multigrid/hierarchy.h"

namespace frictioncg {

/// One cycle of the hierarchy of A on the free face: held dofs are cut out on every level. What
/// friction adds (J'') enters as springs on the tangents; those whose regularization is far stiffer
/// than A leave the hierarchy, too, and get r over their stiffness: single precision would lose A
/// beside them.
class MultigridPreconditioner final : public ResidualPreconditioner {
 public:
  /// Throws IllegalInput where the system allows no hierarchy.
  explicit MultigridPreconditioner(const System& system);

 private:
  void apply(const Vector& r, Vector& z) const override;
  void update(const ContactPart& part) override;
  bool fits(const ContactPart& part) const;

  const std::unique_ptr<Hierarchy> hierarchy_;
  std::vector<char> cut_;   ///< contact dofs that the hierarchy leaves out
  Vector springs_;          ///< contact_dofs, what the hierarchy has of J'' [force/length]
  std::vector<char> free_;  ///< contact dofs
  Vector hessian_;          ///< contact_dofs
};

}  // namespace frictioncg
