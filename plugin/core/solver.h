#pragma once
#include "certificate.h"
#include "settings.h"
#include "tresca.h"

namespace frictioncg {

/// What the scene needs, decided before anything is solved; what is absent is left out.
struct Plan {
  Index dofs = 0, nodes = 0, tangents = 0;
  Law law = Law::frictionless;
  bool fixed_point = false;     ///< law coulomb: g depends on the answer
  bool regularization = false;  ///< friction by a conjugate gradient
};

Plan make_plan(const ContactProblem& problem, const Settings& settings);

struct Solution {
  Status status = Status::converged;
  Vector x;                      ///< n, the increment in local frames [length]
  Certificate certificate;       ///< of x
  std::vector<NodeState> state;  ///< m
  Index iterations = 0;          ///< of all minimizations
  Index passes = 0;              ///< of the fixed point; 0 where there is none
  Real eps = 0;                  ///< the regularization used [length]; 0: none
};

/// Solves the problem by the method of the settings, and certifies the answer. x0 (n), or empty to
/// start from the scene.
Solution solve(const ContactProblem& problem, const Settings& settings, const Vector& x0 = {},
             Observer* observer = nullptr);

}  // namespace frictioncg
