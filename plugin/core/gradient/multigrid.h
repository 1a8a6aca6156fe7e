#pragma once
#include <memory>

#include "gradient/preconditioner.h"
#include "multigrid/hierarchy.h"

namespace frictioncg {

/// One cycle of the hierarchy of A on the free face: held dofs are cut out on every level. What
/// friction adds (J'') enters as springs on the tangents; those whose regularization is far stiffer
/// than A leave the hierarchy, too, and get r over their stiffness: single precision would lose A
/// beside them.
class MultigridPreconditioner final : public Preconditioner {
 public:
  /// Throws IllegalInput where the system allows no hierarchy.
  explicit MultigridPreconditioner(const System& system);
  void start(const Vector& r) override;
  void set_contact(const Vector& r_C, const ContactPart& part) override;
  void direction(Real gamma, Vector& v) override;
  Curvature curvature(const Vector& v) override;
  void advance(Real rho, const Vector& v, Vector& x) override;
  void move_contact(const Vector& dx_C) override;
  Real r_z() const override { return z(), products_.r_z; }
  Real dr_z() const override { return z(), products_.dr_z; }
  Real r_v(const Vector& v) const override { return r_.dot(v); }
  Real free_norm() const override;

 private:
  const Vector& z() const;
  bool fits(const ContactPart& part) const;

  const std::unique_ptr<Hierarchy> hierarchy_;
  Vector r_;                ///< n, zero where held
  Vector dr_;               ///< n, its change by the last advance and what follows it
  Vector Av_;               ///< n, of the last direction
  std::vector<char> cut_;   ///< contact dofs that the hierarchy leaves out
  Vector springs_;          ///< contact_dofs, what the hierarchy has of J'' [force/length]
  std::vector<char> free_;  ///< contact dofs
  Vector hessian_;          ///< contact_dofs
  // as of the last set_contact, made when they are asked for
  mutable Vector z_;  ///< n, P r
  mutable struct { Real r_z, dr_z; } products_{0, 0};
  mutable bool z_is_old_ = true;
};

}  // namespace frictioncg
