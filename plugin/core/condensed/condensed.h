#pragma once
#include "condensed/semismooth_newton.h"
#include "condensed/elimination.h"

namespace frictioncg {

/// The condensed route: the interior eliminated by one factorization, which is kept for further
/// loads, gaps and laws; then contact and friction on the dense S alone.
class CondensedSolver {
 public:
  /// A central path on A, of at most so many steps, where that is cheaper than on S; else nothing.
  using PathOnA = std::function<std::optional<Solution>(Index max_steps)>;

  explicit CondensedSolver(SystemPtr system) : system_(std::move(system)) {}

  Elimination::Outcome factor(double memory_bound) {
    positive_on_.clear();
    return elimination_.factor(*system_, memory_bound);
  }
  /// Another matrix on the same dofs, to be factored; same_pattern: over the layout of the last.
  void renew(SystemPtr system, bool same_pattern) {
    system_ = std::move(system);
    if (!same_pattern) elimination_.forget_layout();
  }

  /// settings.newton: semismooth Newton on the unregularized laws, and where it does not arrive an
  /// interior point and springs before it; else the regularized conjugate gradient and the fixed
  /// point on S. Without x0 it starts from the last answer. problem.system is the one that was
  /// factored.
  Solution solve(const Request& request, const PathOnA& path = {});

  /// An answer at which A has negative energy, in a motion of open nodes or one that slip goes on
  /// with, is none: it is where a body that buckles has not buckled. Nodes that slip and would turn
  /// back are held by friction. s: not_positive_definite there, with s.negative
  void look_for_negative_energy(const ContactProblem& problem, Solution& s);

  const Elimination& elimination() const { return elimination_; }

 private:
  struct Run;
  void refine(Run& run, Vector start);
  CondensedProblem condense(Run& run);
  void recover(Run& run, const Attempt& a);
  Vector keep_if_better(Run& run, const Vector& x, const Attempt& a);
  Attempt solve_laws(Run& run, const CondensedProblem& condensed, const Vector& start);
  Attempt by_newton(const Run& run, const CondensedProblem& condensed, const Vector& start) const;
  Attempt by_gradient(Run& run, const CondensedProblem& condensed, const Vector& start);
  bool unheld(Run& run, const std::optional<Vector>& motion);
  bool unheld_by_anything(Run& run, const CondensedProblem& condensed);
  const DenseMatrix& rigid_motions_of_A(Run& run);
  Vector negative_energy_of(const Branches& branches, const std::vector<char>& slips);
  bool hold_turning_back(const Branches& branches, const Vector& p, std::vector<char>& slips) const;
  void settle(Run& run);
  bool may_be_idle(const Branches& branches) const;

  SystemPtr system_;
  Elimination elimination_;
  Branches last_;                  ///< of the last answer: where an increment starts
  std::vector<char> positive_on_;  ///< contact_dofs: where S is known to be positive definite
};

}  // namespace frictioncg
