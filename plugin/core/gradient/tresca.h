#pragma once
#include "model/law.h"
#include "settings.h"

namespace frictioncg {

/// Where a minimization starts, and where it stands when it ends.
struct Iterate {
  Vector x;                   ///< n, x_N <= gap
  std::vector<char> contact;  ///< m, 1: held at the gap
};

struct Outcome {
  Status status = Status::converged;
  Index iterations = 0;
};

/// Where the tangential dofs of a minimization stand.
enum class Tangents {
  sliding,  ///< free, braked by friction at the sliding limit
  stuck     ///< held at x_T = 0, whatever the force: the start of the fixed point
};

/// Problem 2 (section 2): minimizes J, or J_eps, at a given sliding limit g over x_N <= gap.
class TrescaSolver {
 public:
  virtual ~TrescaSolver() = default;

  /// g: m [force]; eps [length]. Ends when what is left of the optimality conditions of J (J_eps)
  /// is below tolerance |F|, in norm_D.
  virtual Outcome minimize(Iterate& it, const Vector& g, Real eps, Tangents tangents,
                           Real tolerance) = 0;
  virtual bool regularized() const { return true; }
};

}  // namespace frictioncg
