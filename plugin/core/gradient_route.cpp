#include "gradient_route.h"

#include "gradient/fixed_point.h"
#include "statics/equilibrium.h"
#include "statics/rigid_motions.h"
#include "statics/undetermined.h"

namespace frictioncg {

void decide_on_equilibrium(const ContactProblem& problem, FloatingMotions& floating, Solution& s) {
  const bool open = s.status == Status::stagnated || s.status == Status::fixed_point_diverged ||
                    s.status == Status::max_iterations;
  if (!open) return;
  // The motions of A: from the candidates of the system, or, where none of them floats, by
  // conjugate gradients; not after a call that was to be short, nor where the laws hold but for
  // rounding.
  const DenseMatrix& known = floating();
  const bool enough =
      known.cols() > 0 || s.status == Status::max_iterations || is_rounding(s.certificate);
  const auto motion = unheld_motion(
      enough ? known : rigid_motions(*problem.system, default_iterations(problem)), problem);
  s.unheld_motion = motion.value_or(Vector());
  if (motion) s.status = Status::no_equilibrium;
}

Solution by_gradients(const Request& request, FloatingMotions& floating) {
  const auto& [problem, settings, x0, observer] = request;
  const auto tresca = make_tresca_solver(problem, settings, observer);
  Solution s = fixed_point(problem, settings, *tresca, x0);
  s.layer = settings.method == Method::sorp  ? Layer::sorp
            : settings.method == Method::gcx ? Layer::gcx
                                             : Layer::gc;
  decide_on_equilibrium(problem, floating, s);
  // The rigid motions that neither A nor the laws determine are named, and taken out of the answer;
  // where the system knows no candidates for them they are not looked for.
  if (s.certificate.residual > settings.tol) return s;
  s.undetermined = left_free(floating(), problem, branches_of(problem, s.x, s.certificate));
  leave_least(problem, settings.tol, s);
  return s;
}

}  // namespace frictioncg
