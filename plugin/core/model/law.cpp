#include "model/law.h"

namespace frictioncg {

NodeLaw law_of(const Increment& increment, Index i) {
  if (increment.law == Law::tresca) return given_limit(increment.g[i], increment.bilateral);
  NodeLaw law;
  law.bilateral = increment.bilateral;
  if (increment.law == Law::frictionless) return law;
  law.mu = increment.mu[i];
  if (increment.cohesion.size() > 0) law.c = increment.cohesion[i];
  if (increment.cap.size() > 0) law.cap = increment.cap[i];
  return law;
}

Tangent friction_residual(const Tangent& r_T, const Tangent& x_T, Real c, Real g) {
  const Tangent y = r_T + c * x_T;
  const Real norm = y.norm();
  if (norm <= g) return -c * x_T;  // not r_T - y: rounding of r_T would drown a small x_T
  return r_T - (g / norm) * y;
}

Violation violation(const NodeLaw& law, Real gap, const Eigen::Ref<const Vector>& w,
                    const Eigen::Ref<const Vector>& x, const Eigen::Ref<const Vector>& r) {
  const Real closing = w[0] * (gap - x[0]), normal = law.normal_residual(closing, r[0]);
  Violation v{normal * normal / w[0], 0};
  const Index t = static_cast<Index>(w.size()) - 1;
  if (t == 0) return v;
  const auto miss = [&](Real g) {
    return friction_residual(r.tail(t), x.tail(t), w[1], g).squaredNorm() / w[1];
  };
  v.friction = miss(law.limit(closing, r[0]));
  if (!law.coheres()) return v;
  // as a node that touches without a force, whose cohesion is whatever part of it the shear takes
  const Violation touching{(closing * closing + r[0] * r[0]) / w[0],
                           miss(std::min(r.tail(t).norm(), law.limit(0)))};
  return touching.normal + touching.friction < v.normal + v.friction ? touching : v;
}

Violation violation(const ContactProblem& problem, const Vector& w, const Vector& x,
                    const Vector& r) {
  Violation sum;
  const Index left_out = problem.dofs() - static_cast<Index>(x.size());
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = problem.system->first[i] - left_out, size = problem.tangents(i) + 1;
    const Violation v = violation(law_of(problem.increment, i), problem.increment.gap[i],
                                  w.segment(N, size), x.segment(N, size), r.segment(N, size));
    sum.normal += v.normal;
    sum.friction += v.friction;
  }
  return sum;
}

}  // namespace frictioncg
