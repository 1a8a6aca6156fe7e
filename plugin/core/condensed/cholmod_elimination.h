#pragma once
#include <cholmod.h>

#include "condensed/elimination.h"
#include "condensed/ordering.h"

namespace frictioncg {

/// Elimination by CHOLMOD's supernodal Cholesky factorization.
///
/// With the contact dofs last, the trailing block of the factor of A + sigma D_CC is the factor of
/// S + sigma D_CC: the Schur complement S comes with the factorization that one linear solve needs
/// anyway. The shift sigma D_CC on the contact dofs makes it exist wherever they block the rigid
/// motions, and is subtracted from S; the interior never sees it.
///
/// A rigid motion that the contact dofs do not block shows as a pivot of the interior that rounding
/// alone keeps from 0. A spring sigma D to the ground at that dof stands in for the support: the
/// motion being rigid, no force that is balanced over it ever loads the spring, and S, f and the
/// field are exact.
class CholmodElimination final : public Elimination {
 public:
  explicit CholmodElimination(Ordering ordering = Ordering::automatic);
  ~CholmodElimination() override;
  CholmodElimination(const CholmodElimination&) = delete;
  CholmodElimination& operator=(const CholmodElimination&) = delete;

  Outcome factor(const System& system, double memory_bound, bool again = false) override;
  double memory_needed() const override { return memory_needed_; }
  const DenseMatrix& S() const override { return S_; }
  Vector condense(const Vector& F) override;
  Vector recover(const Vector& x_C) override { return back_substitute(y_, x_C); }
  Vector extend(const Vector& w_C) override { return back_substitute(Vector::Zero(n_), w_C); }
  const DenseMatrix& floating() const override { return floating_; }
  const EliminationTimes& times() const override { return times_; }

 private:
  struct UpperTriangle;
  bool analyze(const System& system, UpperTriangle& A);
  bool contact_is_last() const;
  bool factorize(const System& system, UpperTriangle& A);
  Index dof_of_smallest_pivot(const System& system) const;
  bool find_floating(const System& system);
  void form_S(const Vector& D_C);
  template <class Visit>
  void for_each_trailing(Visit visit) const;
  Vector back_substitute(Vector y, const Vector& x_C);
  Vector solve(int triangle, const Vector& rhs);
  void release();

  cholmod_common common_;
  cholmod_factor* L_ = nullptr;
  cholmod_dense *X_ = nullptr, *Y_ = nullptr, *E_ = nullptr;  ///< kept by cholmod_solve2
  const Ordering ordering_;
  Index n_ = 0, interior_ = 0;
  std::vector<Index> roots_;    ///< of UpperTriangle
  std::vector<Index> springs_;  ///< dofs of the interior that stand in for supports
  double memory_needed_ = 0;
  DenseMatrix S_, floating_;
  Vector y_;  ///< n, L^{-1} P F
  EliminationTimes times_;
};

}  // namespace frictioncg
