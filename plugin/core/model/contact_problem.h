#pragma once
#include "model/increment.h"
#include "model/system.h"

namespace frictioncg {

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
};

/// |r| in the norm of weight^{-1/2}: the unit in which residuals are measured. Invariant under a
/// change of units up to a factor that |F| shares, and under rotation.
Real norm_D(const System& system, const Vector& r);

/// What drives the increment, in norm_D: the norm of its load F, or, without a load, of the forces
/// that close the initial penetration (bilateral: the gap); 0 where there is neither.
Real driving_norm(const System& system, const Increment& increment);

/// |x_T| at contact node i.
inline Real tangential_norm(const System& s, Index i, const Vector& x) {
  return x.segment(s.first[i] + 1, s.tangents(i)).norm();
}

}  // namespace frictioncg
