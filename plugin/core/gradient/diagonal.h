#pragma once
#include "gradient/preconditioner.h"

namespace frictioncg {

/// C = I, diag(A) or diag(J''): r itself is kept.
class DiagonalPreconditioner final : public Preconditioner {
 public:
  DiagonalPreconditioner(const System& system, Precon kind);
  void start(const Vector& r) override;
  void set_contact(const Vector& r_C, const ContactPart& part) override;
  void direction(Real gamma, Vector& v) override;
  Curvature curvature(const Vector& v) override;
  void advance(Real rho, const Vector& v, Vector& x) override;
  void move_contact(const Vector& dx_C) override;
  Real r_v(const Vector& v) const override { return r_.dot(v); }
  Real free_norm() const override;

 private:
  const bool on_hessian_;
  Vector C_;   ///< the diagonal
  Vector r_;   ///< zero where masked
  Vector Av_;  ///< of the last direction
  Real interior_r_z_ = 0, interior_dr_z_ = 0;
};

}  // namespace frictioncg
