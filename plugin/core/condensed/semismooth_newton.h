#pragma once
#include "condensed/condensed_problem.h"
#include "model/branch.h"
#include "solution.h"

namespace frictioncg {

/// Semismooth Newton (primal-dual active set) on the unregularized coupled laws. With c > 0, r the
/// force of the body on the obstacle, g the sliding limit (model/law.h), y = r_T + c x_T:
///   normal:    r_N = max(0, r_N + A_NN (x_N - gap)); bilateral: x_N = gap
///   friction:  r_T - g y / max(g, |y|) = 0
/// One step solves the linear system of the present branches: open r_N = 0; closed x_N = gap; stick
/// x_T = 0; slip r_T = g d + w P x_T, d = y/|y|, P = I - dd', w = g c/(|y| - g), g depending on x.
///
/// The row of slip: the derivative of r_T - g y/|y| = 0, with q = g/|y| and Py = 0, makes
///   (r_T - g d) + dr_T - d dg - q P (dr_T + c dx_T) = 0
///   along d:   d'(r_T + dr_T) = g + dg
///   across d:  P r_T + (1 - q) P dr_T - q c P dx_T = 0, where P r_T = -c P x_T as Py = 0, so that
///              P (r_T + dr_T) = w P (x_T + dx_T),  w = q c/(1 - q)
class SemismoothNewton {
 public:
  enum class Outcome { converged, cycled, stalled, singular, exhausted, ran_away };

  /// Starts from stick, unless it is told otherwise: every node closed, x_T = 0.
  explicit SemismoothNewton(const CondensedProblem& problem);

  void start_from(const Vector& x);  ///< the branches that x is on
  void start_from(const Branches& branches);

  /// At most max_steps steps; converged where the laws hold to rounding. ran_away: from stick, and
  /// the forces that violate the laws grow.
  Outcome solve(Index max_steps);

  const Vector& x() const { return x_; }
  const Branches& branches() const { return branch_; }
  Index steps() const { return steps_; }
  Real residual() const { return residual_; }  ///< of the laws on S: their share of the certificate
  /// The last step left a motion free, and took the least.
  bool undetermined() const { return undetermined_; }
  /// S is positive definite on the unknowns of the last step, and known to be.
  bool positive() const { return positive_; }

 private:
  void choose_branches();
  bool step();
  template <class Visit>
  void for_each_slip(Visit visit) const;
  bool assemble();
  Vector solve_branches();
  bool ran_away() const;
  Real rounding() const;
  Real unit() const;
  std::size_t fingerprint() const;

  const CondensedProblem& problem_;
  Vector c_;  ///< m, one scalar per node, so that the tangential frame does not matter
  Branches branch_;
  Vector x_, r_;
  std::vector<Index> unknown_;
  DenseMatrix M_;
  Vector rhs_, b_, scale_, factor_;
  std::vector<Index> normal_;  ///< of the unknowns, the normal dof that factor_ refers to
  Index steps_ = 0;
  Real residual_ = 0;
  bool undetermined_ = false, positive_ = false, from_stick_ = true;
};

/// How an attempt at the laws on the contact dofs ended.
struct Attempt {
  Vector x;           ///< contact_dofs; empty where nothing was found
  Branches branches;  ///< of x, where Newton's method found it
  bool solved = false;
  bool undetermined = false;  ///< a motion is free, and x has the least
  bool positive = false;      ///< S is known to be positive definite on open nodes
  Index steps = 0;            ///< of Newton's method, solved or not
  Status status = Status::stagnated;
};

/// Newton's method from the branches of x, or where x is empty from given ones, or where these are
/// from stick: the rest of max_steps, at most 40. True where it arrives; a is then its answer, and
/// else keeps the one it has.
bool newton_from(const Vector& x, const CondensedProblem& problem, Index max_steps, Attempt& a,
                 const Branches& given = {});

/// Proximal points (model/proximal_springs.h), where Newton's method alone does not arrive: from
/// x_0 = 0 by Newton's method with springs, until it arrives from x_k without them. At most
/// max_steps of Newton's method.
Attempt by_proximal_points(const CondensedProblem& problem, Index max_steps);

}  // namespace frictioncg
