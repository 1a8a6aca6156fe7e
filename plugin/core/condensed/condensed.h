#pragma once
#include "condensed/condensation.h"
#include "condensed/semismooth_newton.h"
#include "solution.h"

namespace frictioncg {

/// The condensed route: the interior eliminated by one factorization, which is kept for further
/// loads, gaps and laws; then contact and friction on the dense S alone.
class CondensedSolver {
 public:
  explicit CondensedSolver(SystemPtr system) : system_(std::move(system)) {}

  /// Factors A. Status::not_positive_definite where contact and supports leave it singular.
  Condensation::Outcome factor(double memory_bound) {
    return condensation_.factor(*system_, memory_bound);
  }

  /// settings.polish: semismooth Newton on the unregularized laws; else the regularized conjugate
  /// gradient and the fixed point on S.
  /// problem.system is the one that was factored.
  Solution solve(const ContactProblem& problem, const Settings& settings, const Vector& x0);

  const Condensation& condensation() const { return condensation_; }

 private:
  struct Attempt {
    Vector x;
    bool solved = false;
    Status status = Status::converged;
  };
  Attempt polish(const CondensedProblem& condensed, const Vector* x_C, Solution& s);
  Attempt by_continuation(const CondensedProblem& condensed, Solution& s);
  Attempt by_fixed_point(const CondensedProblem& condensed, const Settings& settings,
                         const Vector& x_C, Solution& s);

  SystemPtr system_;
  Condensation condensation_;
  std::vector<SemismoothNewton::Branch> last_;  ///< of the last answer: where an increment starts
};

}  // namespace frictioncg
