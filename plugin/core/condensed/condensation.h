#pragma once
#include <cholmod.h>

#include <Eigen/Dense>

#include "model/system.h"

namespace frictioncg {

using DenseMatrix = Eigen::MatrixXd;

/// How the interior is ordered before the contact dofs, which always come last. All three work on
/// the graph of the mesh nodes, whose d dofs stay together: d^2 times fewer edges than between
/// dofs.
enum class Ordering {
  automatic,
  camd,  ///< minimum degree with the contact dofs as the last class
  amd,   ///< minimum degree of the interior, contact dofs appended
  metis  ///< nested dissection of the interior, contact dofs appended
};

/// CPU seconds of each phase.
struct CondensationTimes {
  double order = 0, factor = 0, condense = 0;
};

/// Elimination of the interior: S x_C = f - r_C on the contact dofs.
///
/// With the contact dofs last, the trailing block of the Cholesky factor of A + sigma D_CC is the
/// factor of S + sigma D_CC: the Schur complement S comes with the factorization that one linear
/// solve needs anyway. The shift sigma D_CC on the contact dofs makes it exist wherever they block
/// the rigid motions, and is subtracted from S; the interior never sees it.
class Condensation {
 public:
  enum class Outcome { done, not_positive_definite, too_large };

  Condensation();
  ~Condensation();
  Condensation(const Condensation&) = delete;
  Condensation& operator=(const Condensation&) = delete;

  /// Factors A. memory_bound [bytes] is for the factor and the dense matrices on the contact dofs.
  Outcome factor(const System& system, double memory_bound,
                 Ordering ordering = Ordering::automatic);

  const DenseMatrix& S() const { return S_; }  ///< contact_dofs square, symmetric

  /// f = F_C - A_CI A_II^{-1} F_I; keeps what expand needs of F.
  Vector reduce(const Vector& F);

  /// x (n) from x_C, for the load of the last reduce: A_II x_I = F_I - A_IC x_C.
  Vector expand(const Vector& x_C);

  double factor_bytes() const;
  const CondensationTimes& times() const { return times_; }

 private:
  bool contact_is_last() const;
  template <class Visit>
  void for_each_trailing(Visit visit) const;
  void read_trailing_block();
  void multiply_by_transpose();
  Vector solve(int triangle, const Vector& rhs);
  void release();

  cholmod_common common_;
  cholmod_factor* L_ = nullptr;
  cholmod_dense *X_ = nullptr, *Y_ = nullptr, *E_ = nullptr;  ///< kept by cholmod_solve2
  Index n_ = 0, interior_ = 0;
  DenseMatrix S_;
  Vector y_;  ///< n, L^{-1} P F
  CondensationTimes times_;
};

}  // namespace frictioncg
