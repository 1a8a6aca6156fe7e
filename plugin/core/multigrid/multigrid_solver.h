#pragma once
#include <Eigen/Core>
#include <memory>

#include "multigrid/faces.h"
#include "solution.h"

namespace frictioncg {

/// The scalable route: the hierarchy of A, kept for further loads, gaps and laws; then inexact
/// semismooth Newton steps on the unregularized laws.
class MultigridSolver {
 public:
  /// modes: rigid motions in the dofs of the system (n x 3 in 2D, n x 6 in 3D). The system must
  /// tell its mesh nodes. Throws IllegalInput where one of them is missing.
  MultigridSolver(SystemPtr system, const Eigen::MatrixXd& modes);

  Solution solve(const ContactProblem& problem, const Settings& settings, const Vector& x0);

  const Hierarchy& hierarchy() const { return *hierarchy_; }

 private:
  SystemPtr system_;
  std::unique_ptr<Hierarchy> hierarchy_;
  Eigen::MatrixXd motions_;  ///< n x k: those of the modes that A does no work on
  std::vector<Face> last_;   ///< of the last answer: where an increment starts
  double setup_ = 0;         ///< CPU seconds, until they are reported
};

}  // namespace frictioncg
