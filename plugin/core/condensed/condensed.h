#pragma once
#include <memory>

#include "condensed/continuation.h"
#include "condensed/elimination.h"
#include "solution.h"

namespace frictioncg {

/// The condensed route: the interior eliminated by one factorization, which is kept for further
/// loads, gaps and laws; then contact and friction on the dense S alone.
class CondensedSolver {
 public:
  explicit CondensedSolver(SystemPtr system);

  Elimination::Outcome factor(double memory_bound) {
    return elimination_->factor(*system_, memory_bound);
  }

  /// settings.newton: semismooth Newton on the unregularized laws, and what follows where it does
  /// not arrive; else the regularized conjugate gradient and the fixed point on S.
  /// problem.system is the one that was factored.
  Solution solve(const ContactProblem& problem, const Settings& settings, const Vector& x0);

  const Elimination& elimination() const { return *elimination_; }

 private:
  struct Run;
  struct Answer {
    Vector x_C;
    bool solved = false, undetermined = false;
    Status status = Status::converged;
  };
  void refine(Run& run, const Vector& x0);
  Answer solve_laws(Run& run, const CondensedProblem& condensed, const Vector* x_C);
  Answer by_newton(Run& run, const CondensedProblem& condensed, const Vector* x_C);
  Answer by_fixed_point(Run& run, const CondensedProblem& condensed, const Vector* x_C);
  bool unheld(Run& run);
  void find_rigid_motions(Run& run);
  DenseMatrix left_free(Run& run);
  void rest(Run& run);

  SystemPtr system_;
  std::unique_ptr<Elimination> elimination_;
  std::vector<SemismoothNewton::Branch> last_;  ///< of the last answer: where an increment starts
};

}  // namespace frictioncg
