#pragma once
#include "solution.h"

namespace frictioncg {

/// How a minimization ended, and what it took.
struct Outcome {
  Status status = Status::converged;
  StepCounts steps;
  Vector negative;  ///< not_positive_definite: n, the direction
  Index iterations() const { return steps.total(); }
};

/// Where the tangential dofs of a minimization stand.
enum class Tangents {
  sliding,  ///< free, braked by friction at the sliding limit
  stuck     ///< held at x_T = 0, whatever the force: the start of the fixed point
};

/// Problem 2 (section 2): minimizes J of (3), (5), or J_eps of (11), at a given sliding limit g
/// over x_N <= gap. The bound on the iterations is shared by all minimizations of one solver.
class TrescaSolver {
 public:
  virtual ~TrescaSolver() = default;

  /// x: n, where it starts (put on x_N <= gap first) and where it ends. g: m [force]; eps [length].
  /// Converged where the norm (norm_D) of what is left of the optimality conditions of J (J_eps) is
  /// below bound.
  virtual Outcome minimize(Vector& x, const Vector& g, Real eps, Tangents tangents, Real bound) = 0;

  /// Whether it minimizes J_eps, and needs eps > 0 where there is friction.
  virtual bool regularized() const { return true; }

  /// How many passes of the fixed point may go by without a better g.
  virtual Index patience() const { return 15; }
};

/// The method of the settings, which bound all its minimizations together. The observer may be
/// null.
std::unique_ptr<TrescaSolver> make_tresca_solver(const ContactProblem& problem,
                                                 const Settings& settings, Observer* observer);
std::unique_ptr<TrescaSolver> make_sorp(const ContactProblem& problem, const Settings& settings,
                                        Observer* observer);

}  // namespace frictioncg
