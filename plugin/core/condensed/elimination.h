#pragma once
#include "condensed/sparse_factor.h"
#include "solution.h"

namespace frictioncg {

/// Elimination of the interior of one system:  S x_C = f - r_C  on the contact dofs.
///   S = A_CC - A_CI A_II^{-1} A_IC,  f = F_C - A_CI A_II^{-1} F_I
///
/// By CHOLMOD's supernodal Cholesky factorization: with the contact dofs last, the trailing block
/// of the factor of A + sigma D_CC is the factor of S + sigma D_CC, and S comes with the
/// factorization that one linear solve needs anyway. The shift sigma D_CC on the contact dofs makes
/// it exist wherever they block the rigid motions, and is subtracted from S; the interior never
/// sees it. Where stresses give A negative energy in motions that contact blocks, sigma grows.
///
/// Where A_II is singular, some rigid motions leave every contact dof where it is (a body on a
/// frictionless plane may float along it): contact never sees them, S and f exist all the same, and
/// they are named. Such a motion shows as a pivot of the interior that rounding alone keeps from 0.
/// A spring sigma D to the ground at that dof stands in for the support: the motion being rigid, no
/// force that is balanced over it ever loads the spring, and S, f and the field are exact.
class Elimination : private SparseFactor {
 public:
  enum class Outcome { done, not_positive_definite, too_large };

  Elimination() : SparseFactor(CHOLMOD_SUPERNODAL) {}
  /// Whether threads of the BLAS are worth their CPU time, be it on S alone: two of them take 0.7
  /// of the time on 4000 contact dofs, 0.9 to 1 on 2000.
  bool threads_pay() const { return SparseFactor::threads_pay() || n_ - interior_ > 3000; }

  /// memory_bound [bytes] is for the factor and the dense matrices on the contact dofs. A system
  /// after another has its pattern, whose ordering and layout stay, or they are forgotten before.
  Outcome factor(const System& system, double memory_bound);
  void forget_layout() { laid_out_ = false; }
  /// What factor needs at least, as far as it is known before anything is factored [bytes].
  double memory_needed() const { return memory_needed_; }
  const DenseMatrix& S() const { return S_; }  ///< contact_dofs square, symmetric
  Vector condense(const Vector& F);            ///< f (contact_dofs) from F (n)
  /// x (n) from x_C, for the load of the last condense: A_II x_I = F_I - A_IC x_C.
  Vector recover(const Vector& x_C) { return back_substitute(y_, x_C); }
  /// The same without a load: the motion of the body that moves the contact dofs by w_C.
  Vector extend(const Vector& w_C) { return back_substitute(Vector::Zero(n_), w_C); }
  /// n x k: rigid motions of A that vanish on the contact dofs.
  const DenseMatrix& floating() const { return floating_; }
  /// Of order, factor and condense, once.
  Times take_times() { return std::exchange(times_, {}); }

 private:
  bool analyze(const System& system, UpperTriangle& A);
  bool contact_is_last() const;
  bool factorize(const System& system, UpperTriangle& A, DenseMatrix& known);
  Index dof_of_smallest_pivot(const System& system) const;
  bool find_floating(const System& system, const DenseMatrix& known);
  void form_S(const Vector& D_C);
  template <class Visit>
  void for_each_trailing(Visit visit) const;
  Vector back_substitute(Vector y, const Vector& x_C);

  bool laid_out_ = false;  ///< a system has been factored
  Index n_ = 0, interior_ = 0;
  Real shift_ = 0;              ///< sigma of the contact dofs
  std::vector<Index> roots_;    ///< interior dofs that shall be children of the first contact dof
  std::vector<Index> springs_;  ///< dofs of the interior that stand in for supports
  double memory_needed_ = 0;
  DenseMatrix S_, floating_;
  Vector y_;  ///< n, L^{-1} P F
  Times times_;
};

}  // namespace frictioncg
