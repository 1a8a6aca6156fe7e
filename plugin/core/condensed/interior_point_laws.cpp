// The laws of the central path, linear in a step.
#include "condensed/interior_point.h"
#include "model/law.h"

namespace frictioncg {

/// The laws of all nodes, linear in dy, for a target tau; before: the predictor, whose products
/// they take into account.
void CentralPath::linearize(Real tau, const Point* before) {
  const Index n = static_cast<Index>(f_.size()), most = problem_.system->dimension - 1;
  alpha_.setZero(nodes_);
  omega_.setZero(nodes_);
  friction_.a.setZero(n);
  friction_.e.setZero(n);
  friction_.B.setZero(n, most);
  friction_.rest.setZero(nodes_);
  for (Index i = 0; i < nodes_; ++i) {
    if (closes_[i]) {
      // s dN + N ds = tau - s N,  ds = (gap - y - s) - dy
      const Real s = at_.s[i], N = at_.N[i], left = gap_[i] - at_.y[normal(i)] - s;
      const Real rest = tau - s * N - (before ? before->s[i] * before->N[i] : 0);
      alpha_[i] = (rest - N * left) / s;
      omega_[i] = N / s;
    }
    if (rubs_[i]) linearize_friction(i, tau, before);
  }
}

/// With r = r_T, x = x_T, and dg = mu dN:
///   g dt + t dg - r.dx - x.dr = tau - (g t - r.x)
///   t dr + r dt - g dx - x dg = -(t r - g x)
/// dt from the first, in the second:
///   (t I + r x'/g) dr = c - r c_t/g + (g I - r r'/g) dx + (x + r t/g) slope dN
void CentralPath::linearize_friction(Index i, Real tau, const Point* before) {
  using Small = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, 2, 2>;
  const Index T = normal(i) + 1, d = tangents(i);
  const Tangent r = at_.T.segment(T, d), x = at_.y.segment(T, d);
  const Real g = limit(i, at_), t = at_.t[i];
  Real& rest = friction_.rest[i];
  rest = tau - g * t + r.dot(x);
  Tangent c = g * x - t * r;
  if (before) {
    const Tangent dr = before->T.segment(T, d), dx = before->y.segment(T, d);
    const Real dg = slope(i) * before->N[i];
    rest -= dg * before->t[i] - dr.dot(dx);
    c -= before->t[i] * dr - dg * dx;
  }
  const Small I = Small::Identity(d, d);
  const Small inverse = (I - r * x.transpose() / (g * t + r.dot(x))) / t;
  friction_.a.segment(T, d) = inverse * (c - r * (rest / g));
  friction_.e.segment(T, d) = inverse * (x + r * (t / g)) * slope(i);
  friction_.B.block(T, 0, d, d) = inverse * (g * I - r * r.transpose() / g);
}

}  // namespace frictioncg
