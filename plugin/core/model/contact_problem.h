#pragma once
#include "types.h"

namespace frictioncg {

enum class Law { frictionless, tresca, coulomb };

/// Discrete contact problem of one increment, in local frames.   section 2, eqs. (1), (4)-(6)
///
///   min 1/2 x'Ax - F'x + sum_i g_i |x_T,i|   over   x_N,i <= gap_i
///   g given (tresca), or g_i = mu_i |F_N,i(x)| (coulomb), or g = 0 (frictionless)
///   bilateral contact: x_N,i = gap_i in place of the inequality, and F_N of either sign
///
/// x is the increment u^k - u^{k-1}; gap is what u^{k-1} leaves of the gap; F is what u^{k-1}
/// leaves of the load. The interior dofs come first, then the contact nodes one by one, each with
/// its normal dof followed by its tangential dofs: two in 3D, one in 2D, none where there is no
/// friction. Forces of the obstacle on the body: F_N = (Ax - F)_N <= 0 and F_T = (Ax - F)_T.
struct ContactProblem {
  int dimension = 2;             ///< 2 or 3
  Matrix A;                      ///< n x n, symmetric positive semi-definite [force/length]
  Vector D;                      ///< n, diag(A)
  Vector F;                      ///< n [force]
  std::vector<Index> first;      ///< m + 1; contact node i owns the dofs first[i] .. first[i+1]-1
  Vector gap;                    ///< m [length]
  std::vector<Index> mesh_node;  ///< n, or empty: dofs with one number share a mesh node (fill-in)
  Law law = Law::frictionless;
  bool bilateral = false;  ///< no separation
  Vector mu;               ///< m, >= 0, dimensionless; law coulomb
  Vector g;                ///< m, >= 0 [force]; law tresca
  Real force_scale = 0;    ///< norm of the total load, in the norm of norm_D below; > 0

  Index dofs() const { return static_cast<Index>(F.size()); }
  Index nodes() const { return static_cast<Index>(first.size()) - 1; }
  Index interior() const { return first.front(); }
  Index contact_dofs() const { return dofs() - interior(); }
  Index tangents(Index i) const { return first[i + 1] - first[i] - 1; }
};

/// |r| in the norm of D^{-1/2}, D = diag(A): the unit in which residuals are measured. Invariant
/// under a change of units up to a factor that |F| shares.
Real norm_D(const ContactProblem& problem, const Vector& r);

/// The unit of the residuals: the norm of the load, or, without a load, of the force that closes
/// the initial penetration; 1 where there is neither.
Real load_norm(const ContactProblem& problem);

/// |x_T| at contact node i.
inline Real tangential_norm(const ContactProblem& p, Index i, const Vector& x) {
  return x.segment(p.first[i] + 1, p.tangents(i)).norm();
}

}  // namespace frictioncg
