#pragma once
#include "settings.h"
#include "model/system.h"

namespace frictioncg {

/// <Av, v> and <Dv, v>: their ratio tells a rigid motion from a deformation.
struct Curvature {
  Real A = 0, D = 0;
};

/// What the preconditioner sees of the contact dofs (sizes: contact_dofs()).
struct ContactPart {
  std::vector<char> free;  ///< 0 where the dof is held by the obstacle: masked everywhere
  Vector hessian;          ///< g phi'' of (17), 0 at normals [force/length]
};

/// z = P r of eq. (15) on the free dofs, P = C^{-1}, together with the residual r it acts on.
///
/// The two go together because SSOR keeps y = (D/omega + E)^{-1} r in place of r (Eisenstat's
/// trick): then one iteration, P r and A v together, passes over A once. The contact dofs come last
/// in the numbering, so what changes there (the mask, the Hessian, friction) never touches the
/// interior part of y, and costs only the contact rows.
///
/// The order of calls in one iteration:  direction, curvature, advance, set_contact.
class Preconditioner {
 public:
  explicit Preconditioner(const System& system)
      : system_(system), interior_(system.interior()), D_(system.D) {}
  virtual ~Preconditioner() = default;

  /// Starts from r = F - Ax - g phi'(x_T) (n), of which the interior is kept; then set_contact.
  virtual void start(const Vector& r) = 0;

  /// The contact rows of r, the mask or the Hessian have changed: r_C of size contact_dofs().
  virtual void set_contact(const Vector& r_C, const ContactPart& part) = 0;

  /// v = P r + gamma v
  virtual void direction(Real gamma, Vector& v) = 0;

  /// <Av, v>, and keeps Av for advance.
  virtual Curvature curvature(const Vector& v) = 0;

  /// x += rho v, and r -= rho A v on the interior dofs; set_contact has to follow.
  virtual void advance(Real rho, const Vector& v, Vector& x) = 0;

  /// x has been moved by dx_C (contact_dofs()) on the contact dofs alone: r -= A dx on the
  /// interior. Half a pass over A; set_contact has to follow, and a restart.
  virtual void move_contact(const Vector& dx_C) = 0;

  virtual Real r_z() const = 0;                 ///< <r, P r>, of the last set_contact
  virtual Real dr_z() const = 0;                ///< <r - r_before_advance, P r>, eq. (12)
  virtual Real r_v(const Vector& v) const = 0;  ///< <r, v>

  /// Norm of r over the free dofs, in norm_D. May cost half a product.
  virtual Real free_norm() const = 0;

 protected:
  const System& system_;
  const Index interior_;
  const Vector& D_;  ///< diag(A)
};

/// Throws IllegalInput where multigrid is asked for and the system allows no hierarchy.
std::unique_ptr<Preconditioner> make_preconditioner(const System& system, Precon kind, Real omega);

/// C = omega/(2-omega) (D/omega + E) D^{-1} (D/omega + E)', eq. (16), with D of A or of J''.
std::unique_ptr<Preconditioner> make_ssor(const System& system, bool on_hessian, Real omega);

}  // namespace frictioncg
