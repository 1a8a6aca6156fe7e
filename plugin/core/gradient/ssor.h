#pragma once
#include "gradient/preconditioner.h"

namespace frictioncg {

/// C = omega/(2-omega) (D/omega + E) D^{-1} (D/omega + E)', eq. (16), with D of A or of J''.
class SsorPreconditioner final : public Preconditioner {
 public:
  SsorPreconditioner(const System& system, bool on_hessian, Real omega);
  void start(const Vector& r) override;
  void set_contact(const Vector& r_C, const ContactPart& part) override;
  void direction(Real gamma, Vector& v) override;
  Curvature curvature(const Vector& v) override;
  void advance(Real rho, const Vector& v, Vector& x) override;
  void move_contact(const Vector& dx_C) override;
  Real r_v(const Vector&) const override { return y_.dot(s_); }
  Real free_norm() const override;

 private:
  void forward_contact(const Vector& lower_interior, const Vector& rhs, Vector& y) const;

  const bool on_hessian_;
  const Real omega_, kappa_;     ///< kappa = (2 - omega)/omega
  std::vector<Index> diagonal_;  ///< n, position of a_ii in the row
  Vector C_;                     ///< n, D of A or of J''
  Vector inverse_;               ///< n, omega/C
  std::vector<char> free_;       ///< contact dofs
  Vector y_;                     ///< (C/omega + E)^{-1} r, zero where masked
  Vector s_;                     ///< (C/omega + E') v
  Vector e_;                     ///< A v = (C/omega + E)(v + e)
  Vector r_C_, E_y_;             ///< contact dofs: r; E_CI y_I
  Vector dr_C_, dE_y_, dy_C_;    ///< what set_contact has changed of r, E_CI y_I and y
  Vector dy_I_;                  ///< interior dofs: what move_contact has changed of y
  bool C_changed_ = false;       ///< since s was formed
  Real interior_r_z_ = 0, interior_dr_z_ = 0;
};

}  // namespace frictioncg
