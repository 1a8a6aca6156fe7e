#pragma once
#include "multigrid/multigrid_solver.h"
#include "sparse/factored_matrix.h"

namespace frictioncg {

/// Of slender bodies: where the first forces violate the laws by more than this share of
/// the load, the body is lifted or hangs, and Newton's method does not settle. Of 60 scenes those
/// that lie, slip or fall stay below 0.28, the others are above 0.78 (tests/bench/routes.edp).
constexpr Real lifts = 0.5;

/// Newton steps on A, each with its own sparse factor, and where they do not settle the central
/// path, by such factors too: for slender bodies, in which hierarchies are poor, contact dofs many
/// and factors cheap.
class SparseSolver {
 public:
  explicit SparseSolver(const SystemPtr& system)
      : factor_(std::make_shared<FactoredMatrix>(system)), newton_(system, factor_) {}

  /// Another matrix of the same pattern.
  void renew(const SystemPtr& system);
  double bytes() const { return factor_->bytes(); }
  double flops() const { return factor_->flops(); }
  bool laid_out() const { return factor_->laid_out(); }
  bool has_answered() const { return answered_; }

  /// Newton's method, then the central path. Without x0 it starts from the last answer.
  Solution solve(const Request& request);
  /// Newton's method alone.
  Solution go_on(const Request& request);
  /// The central path at once.
  Solution follow_path(const Request& request, Index max_steps);
  /// Whether A has no negative energy beside an answer: a body that buckles may not have buckled.
  bool is_definite_at(const ContactProblem& problem, const Solution& s);

 private:
  const std::shared_ptr<FactoredMatrix> factor_;
  MultigridSolver newton_;
  bool answered_ = false;  ///< newton_ has faces to start from
};

}  // namespace frictioncg
