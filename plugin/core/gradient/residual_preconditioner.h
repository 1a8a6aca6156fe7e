#pragma once
#include "gradient/preconditioner.h"

namespace frictioncg {

/// A preconditioner that keeps r itself, and makes z = P r when it is asked for: a call without a
/// further step needs none. What is left to say is what P does.
class ResidualPreconditioner : public Preconditioner {
 public:
  explicit ResidualPreconditioner(const System& system);
  void start(const Vector& r) final;
  void set_contact(const Vector& r_C, const ContactPart& part) final;
  void direction(Real gamma, Vector& v) final;
  Curvature curvature(const Vector& v) final;
  void advance(Real rho, const Vector& v, Vector& x) final;
  void move_contact(const Vector& dx_C) final;
  Real r_z() const final { return z(), products_.r_z; }
  Real dr_z() const final { return z(), products_.dr_z; }
  Real r_v(const Vector& v) const final { return r_.dot(v); }
  Real free_norm() const final;

 protected:
  /// z = P r (n). r is 0 on the dofs that are not free, and z is to be.
  virtual void apply(const Vector& r, Vector& z) const = 0;
  /// The mask or the Hessian may have changed.
  virtual void update(const ContactPart& part) = 0;

 private:
  const Vector& z() const;

  Vector r_;   ///< n, zero where held
  Vector dr_;  ///< n, its change by the last advance and what follows it
  Vector Av_;  ///< n, of the last direction
  // as of the last set_contact, made when they are asked for
  mutable Vector z_;  ///< n, P r
  mutable struct { Real r_z, dr_z; } products_{0, 0};
  mutable bool z_is_old_ = true;
};

}  // namespace frictioncg
