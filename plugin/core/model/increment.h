#pragma once
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
  /// it.
  Real load_norm = 0;
  /// Norm of the rounding that F carries from the terms it was summed of, in norm_D.
  Real rounding = 0;

  /// A load, or what is left of one, counts as rounding up to this, in norm_D.
  Real noise() const { return 10 * rounding; }
};

}  // namespace frictioncg
