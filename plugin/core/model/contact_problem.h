#pragma once
#include "model/system.h"
#include "types.h"

namespace frictioncg {

/// What bounds friction: nothing rubs, |r_T| <= g, or |r_T| <= min(cohesion + mu r_N, cap), where
/// an open node has no cohesion (model/law.h).
enum class Law { frictionless, tresca, coulomb };

/// What changes from increment to increment: the load and the laws. Immutable for one solve.
/// x is the increment u^k - u^{k-1}; gap is what u^{k-1} leaves of the gap; F is what u^{k-1}
/// leaves of the load.
struct Increment {
  Vector F;    ///< n [force]
  Vector gap;  ///< m [length]
  Law law = Law::frictionless;
  bool bilateral = false;  ///< no separation
  Vector mu;               ///< m, >= 0, dimensionless; law coulomb
  Vector cohesion;         ///< m, >= 0 [force], or empty: 0; law coulomb
  Vector cap;              ///< m, >= 0 [force], or empty: none; law coulomb
  Vector g;                ///< m, >= 0 [force]; law tresca
  Real force_scale = 0;    ///< norm of the total load, in norm_D; > 0
  /// Norm of the external load on the free dofs, in norm_D: neither Dirichlet data nor u^{k-1} in
  /// it, nor what the inertia of rigid motions takes (model/inertia.h).
  Real load_norm = 0;
  Real external_norm = 0;  ///< the same with what the inertia takes
  /// Norm of the rounding that F carries from the terms it was summed of, in norm_D.
  Real rounding = 0;

  /// A load, or what is left of one, counts as rounding up to this, in norm_D.
  Real noise() const { return 10 * rounding; }
  /// The load that counts, where forces are known to `known`: of what inertia takes, which carries
  /// bodies on as a whole, so many times that. It is what laws are known to, at tol = 1e-8 beside
  /// contact forces.
  Real load_that_counts(Real known) const {
    return std::max(load_norm, std::min(external_norm, 1e11 * known));
  }
};

/// Discrete contact problem of one increment, in local frames.   section 2, eqs. (1), (4)-(6)
///
///   min 1/2 x'Ax - F'x + sum_i g_i |x_T,i|   over   x_N,i <= gap_i
///   g given (tresca), or g_i = min(c_i + mu_i |F_N,i(x)|, cap_i) (coulomb), or g = 0
///   bilateral contact: x_N,i = gap_i in place of the inequality, and F_N of either sign
///
/// Forces of the obstacle on the body: F_N = (Ax - F)_N <= 0 and F_T = (Ax - F)_T.
struct ContactProblem {
  SystemPtr system;
  Increment increment;

  Index dofs() const { return system->dofs(); }
  Index nodes() const { return system->nodes(); }
  Index interior() const { return system->interior(); }
  Index contact_dofs() const { return system->contact_dofs(); }
  Index tangents(Index i) const { return system->tangents(i); }
  /// The distance by which node i is open at x (n), as a force: NodeLaw's closing.
  Real closing(Index i, const Vector& x) const;
};

/// |r| in the norm of weight^{-1/2}: the unit in which residuals are measured. Invariant under a
/// change of units up to a factor that |F| shares, and under rotation.
Real norm_D(const System& system, const Vector& r);

/// What drives the increment, in norm_D: the norm of its load F, or, without a load, of the forces
/// that close the initial penetration (bilateral: the gap); 0 where there is neither.
Real driving_norm(const System& system, const Increment& increment);
/// The norm of the latter forces, whatever the load.
Real closing_norm(const System& system, const Increment& increment);

/// Limits g (m) that stick meets whatever it takes, where nodes can touch.
Vector limits_of_stick(const ContactProblem& problem);

}  // namespace frictioncg
