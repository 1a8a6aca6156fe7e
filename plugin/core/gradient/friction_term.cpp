#include "gradient/friction_term.h"

namespace frictioncg {

FrictionTerm::FrictionTerm(const ContactProblem& problem)
    : system_(*problem.system),
      r_(Vector::Zero(problem.contact_dofs())),
      part_{std::vector<char>(problem.contact_dofs(), 1), Vector::Zero(problem.contact_dofs())},
      piece_(problem.nodes(), 0) {}

bool FrictionTerm::update(const Vector& x, const Vector& r_C, const ActiveSet& faces,
                          const Vector& g, const Phi& phi) {
  bool crossed = false;
  r_ = r_C;
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Index c = system_.first[i] - system_.interior(), t = system_.tangents(i);
    part_.free[c] = !faces.contact(i);
    if (faces.contact(i)) r_[c] = 0;
    for (Index k = 1; k <= t; ++k) part_.free[c + k] = !faces.at_rest(i);
    part_.hessian.segment(c + 1, t).setZero();
    if (faces.at_rest(i)) {
      r_.segment(c + 1, t).setZero();
    } else if (t > 0 && g[i] > 0) {
      const auto x_T = x.segment(system_.first[i] + 1, t);
      const Real slip = x_T.norm();
      r_.segment(c + 1, t) -= g[i] * phi.slope_over_t(slip) * x_T;
      part_.hessian.segment(c + 1, t).setConstant(g[i] * phi.mean_second_derivative(slip, t));
      const char piece = phi.eps > 0 ? slip <= phi.eps : t == 1 && x_T[0] > 0;
      crossed |= std::exchange(piece_[i], piece) != piece;
    }
  }
  return crossed;
}

Real FrictionTerm::along(const Vector& r_C, const Vector& v) const {
  return (r_C - r_).dot(v.tail(r_C.size()));
}

}  // namespace frictioncg
