#include "solver.h"

#include <cmath>
#include <memory>

#include "fixed_point.h"
#include "projected_cg.h"
#include "sorp.h"

namespace frictioncg {

Plan make_plan(const ContactProblem& problem, const Settings& settings) {
  Plan plan;
  plan.dofs = problem.dofs();
  plan.nodes = problem.nodes();
  plan.tangents = problem.contact_dofs() - problem.nodes();
  plan.law = problem.law;
  plan.fixed_point = problem.law == Law::coulomb;
  plan.regularization = problem.law != Law::frictionless && settings.method != Method::sorp;
  return plan;
}

Solution solve(const ContactProblem& problem, const Settings& settings, const Vector& x0,
             Observer* observer) {
  const Index bound =
      settings.nbiter > 0
          ? settings.nbiter
          : 10000 + 20 * problem.nodes() + static_cast<Index>(20 * std::sqrt(problem.dofs()));
  std::unique_ptr<TrescaSolver> tresca;
  if (settings.method == Method::sorp)
    tresca = std::make_unique<Sorp>(problem, settings, bound, observer);
  else
    tresca = std::make_unique<ProjectedCG>(problem, settings, bound, observer);
  return FixedPoint(problem, settings, *tresca).solve(x0);
}

}  // namespace frictioncg
