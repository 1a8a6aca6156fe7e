#pragma once
#include "multigrid/faces.h"
#include "multigrid/past.h"
#include "solution.h"

namespace frictioncg {

/// For a caller that has another route: this one ends, stagnated, as soon as it costs so many times
/// what multigrid costs as a rule, or where the forces of the first linear system
/// violate the laws by more than so many times the load.
struct Allowance {
  double cost = std::numeric_limits<double>::infinity();
  Real violation = infinity;
};

/// The scalable route: the hierarchy of A, kept for further loads, gaps and laws; then inexact
/// semismooth Newton steps on the unregularized laws.
class MultigridSolver {
 public:
  /// Sets up the hierarchy, where the system tells its mesh nodes and its rigid modes.
  explicit MultigridSolver(SystemPtr system);

  /// With a hierarchy that is made already.
  MultigridSolver(SystemPtr system, std::shared_ptr<Hierarchy> hierarchy);

  /// Another matrix on the same dofs, whose hierarchy is set up by set_up(); the faces of the last
  /// answer stay.
  void renew(SystemPtr system);
  bool is_set_up() const { return set_up_; }
  void set_up();
  /// Another matrix, which the hierarchy has already.
  void take(SystemPtr system);

  bool has_hierarchy() const { return hierarchy_ != nullptr; }

  /// Wants a hierarchy. Starts from x0 (n, or empty), from where the answers before lead to, or
  /// from rest, whichever is nearest to the laws. The faces are those of the last answer, or, where
  /// there is none, or two of them led to the start, those of the start.
  Solution solve(const ContactProblem& problem, const Settings& settings, const Vector& x0,
                 Observer* observer, const Allowance& allowance = Allowance());

  const Eigen::MatrixXd& floating() const { return motions_; }
  /// The answers before count no more.
  void forget();

 private:
  struct Start {
    Vector x, b;  ///< n, b = F - Ax; empty: rest
    bool goes_on = false;
  };
  Start best_of(const ContactProblem& problem, const Vector& x0, const Vector& going_on) const;
  bool shown_unheld(const ContactProblem& problem, Solution& s) const;
  void iterate(const ContactProblem& problem, const Settings& settings, const Vector& x0,
               Observer* observer, const Allowance& allowance, Solution& s);

  SystemPtr system_;
  std::shared_ptr<Hierarchy> hierarchy_;
  Eigen::MatrixXd motions_;  ///< n x k: rigid motions that A leaves free
  Branches last_;            ///< of the last answer: where an increment starts
  Past past_;
  bool set_up_ = true;
  double setup_ = 0;  ///< CPU seconds, until they are reported
};

}  // namespace frictioncg
