#include "gradient/line_search.h"

namespace frictioncg {

namespace {
/// Step (14) has overshot where J' has risen beyond this share of |J'(0)|.
constexpr Real overshoot = 0.5;
/// The recurrence of SSOR leaves so many times the rounding of a product with A in <Av,v>.
constexpr Real rounding_of_recurrence = 10;
/// Friction balances a load along v where it misses no more than this share: that is rounding.
constexpr Real balanced = 1e-12;
/// A search for J' > 0 goes so many times as far with each step.
constexpr Real further = 4;
/// Bracketed Newton goes on until J' is this share of J'(0), or the bracket this share of its end:
/// rounding leaves no less.
constexpr Real flat = 1e-14, narrow = 1e-15;
constexpr int most_newton_steps = 100;
/// False position tells rho to this share of it, as the paper does.
constexpr Real false_position_precision = 1e-4;
constexpr int most_false_positions = 60;
}  // namespace

LineSearch::LineSearch(const System& system, Step step, bool safeguarded)
    : system_(system), step_(step), safeguarded_(safeguarded) {
  nodes_.reserve(system.nodes());
  breaks_.reserve(2 * nodes_.capacity());
  for (Index i = 0; i < system.nodes(); ++i)
    if (system.tangents(i) > 1) single_tangent_ = false;
}

void LineSearch::gather(const Vector& g, const Vector& x, const Vector& v) {
  nodes_.clear();
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Index t = system_.tangents(i);
    if (t == 0 || g[i] == 0) continue;
    const auto x_T = x.segment(system_.first[i] + 1, t);
    const auto v_T = v.segment(system_.first[i] + 1, t);
    const Real vv = v_T.squaredNorm();
    if (vv > 0) nodes_.push_back({g[i], x_T.squaredNorm(), x_T.dot(v_T), vv});
  }
}

Real LineSearch::slope(const Phi& phi, Real rho) const {
  Real friction = 0;
  for (const Node& n : nodes_)
    friction += n.g * phi.slope_over_t(n.slip(rho)) * (n.xv + rho * n.vv);
  return rho * vAv_ - a_ + friction;
}

/// sum g <phi'' v, v> at x + rho v, of (14).
Real LineSearch::friction_curvature(const Phi& phi, Real rho) const {
  Real sum = 0;
  for (const Node& n : nodes_) {
    const Real t = n.slip(rho), along = (n.xv + rho * n.vv) / t;
    const Real radial = t > 0 ? std::min(along * along, n.vv) : n.vv;
    sum += n.g * (phi.second_derivative(t) * radial + phi.slope_over_t(t) * (n.vv - radial));
  }
  return sum;
}

Real LineSearch::operator()(const Phi& phi, const Vector& g, const Vector& x, const Vector& v,
                            const Line& line, Real rho_max) {
  const Real r_v = line.r_v;
  gather(g, x, v);
  vAv_ = costs_no_energy(line.vAv.A, line.vAv.D, rounding_of_recurrence) ? 0 : line.vAv.A;
  a_ = line.a;
  if (nodes_.empty()) return vAv_ > 0 ? std::min(r_v / vAv_, rho_max) : rho_max;
  if (step_ == Step::newton && (!safeguarded_ || vAv_ > 0)) return newton(phi, r_v, rho_max);

  // friction only brakes: the root of J' lies below that of its quadratic part
  Real high = std::min(rho_max, vAv_ > 0 ? r_v / vAv_ : infinity);
  if (high == infinity) {
    Real limit = 0;  // friction's share of J' at infinity
    for (const Node& n : nodes_) limit += n.g * std::sqrt(n.vv);
    if (limit <= a_ * (1 + balanced)) return infinity;
    for (high = 1; slope(phi, high) < 0;) high *= further;
  }
  if (step_ == Step::exact && phi.kind == Regularization::polynomial && single_tangent_)
    return walk(phi, high);
  if (slope(phi, high) <= 0) return high;
  return step_ == Step::exact ? bracketed_newton(phi, high) : false_position(phi, high);
}

/// J(rho) - J(0).
Real LineSearch::rise(const Phi& phi, Real rho) const {
  Real sum = rho * (0.5 * rho * vAv_ - a_);
  for (const Node& n : nodes_) sum += n.g * (phi.value(n.slip(rho)) - phi.value(n.slip(0)));
  return sum;
}

/// (14). J'' at x does not see a kink ahead: where the step crosses one, J' at its end is large, or
/// J has even risen, and (13) by false position takes its place.
Real LineSearch::newton(const Phi& phi, Real r_v, Real rho_max) const {
  const Real curvature = vAv_ + friction_curvature(phi, 0);
  const Real rho = curvature > 0 ? std::min(r_v / curvature, rho_max) : rho_max;
  if (!safeguarded_) return rho;
  const Real s = slope(phi, rho);
  if (s <= 0 || (s <= overshoot * r_v && rise(phi, rho) <= 0)) return rho;
  return false_position(phi, rho);
}

/// REG3 with one tangent: J' is piecewise linear and increasing, with two breakpoints a node.
Real LineSearch::walk(const Phi& phi, Real rho_max) {
  Real constant = -a_, curvature = vAv_;  // J' = constant + curvature rho up to the next break
  breaks_.clear();
  for (const Node& n : nodes_) {
    const Real speed = std::sqrt(n.vv), x = n.xv / speed;  // x along v
    const Real enter = (-phi.eps - x) / speed, leave = (phi.eps - x) / speed;
    const Real limit = n.g * speed;
    if (phi.eps == 0) {  // the kink of |x_T|
      constant += enter > 0 ? -limit : limit;
      if (enter > 0) breaks_.push_back({enter, 2 * limit, 0});
      continue;
    }
    const Real steep = n.g * n.vv / phi.eps, offset = limit * x / phi.eps;
    if (enter > 0) {
      constant -= limit;
      breaks_.push_back({enter, limit + offset, steep});
      breaks_.push_back({leave, limit - offset, -steep});
    } else if (leave > 0) {
      constant += offset;
      curvature += steep;
      breaks_.push_back({leave, limit - offset, -steep});
    } else {
      constant += limit;
    }
  }
  std::sort(breaks_.begin(), breaks_.end(),
            [](const Break& a, const Break& b) { return a.rho < b.rho; });
  Real rho = 0;
  for (const Break& b : breaks_) {
    if (b.rho >= rho_max || constant + curvature * b.rho >= 0) break;
    rho = b.rho;
    constant += b.slope;
    curvature += b.curvature;
  }
  const Real root = curvature > 0 ? -constant / curvature : infinity;
  return std::min(std::max(root, rho), rho_max);
}

/// J'(0) < 0 < J'(high): Newton steps, kept inside the bracket by bisection, to rounding.
Real LineSearch::bracketed_newton(const Phi& phi, Real high) const {
  Real low = 0, rho = high;
  const Real small = flat * std::abs(slope(phi, 0));
  for (int k = 0; k < most_newton_steps; ++k) {
    const Real s = slope(phi, rho);
    if (std::abs(s) <= small || high - low <= narrow * high) break;
    (s < 0 ? low : high) = rho;
    const Real curvature = vAv_ + friction_curvature(phi, rho);
    const Real next = curvature > 0 ? rho - s / curvature : infinity;
    rho = next > low && next < high ? next : 0.5 * (low + high);
  }
  return rho;
}

/// J'(0) < 0 < J'(high): the paper's choice, to 1e-4, halving the weight of an end that stays.
Real LineSearch::false_position(const Phi& phi, Real high) const {
  Real low = 0, slope_low = slope(phi, 0), slope_high = slope(phi, high), rho = high;
  int side = 0;
  constexpr Real precision = false_position_precision;
  for (int k = 0; k < most_false_positions && high - low > precision * high; ++k) {
    const Real next = (low * slope_high - high * slope_low) / (slope_high - slope_low);
    const bool settled = std::abs(next - rho) <= precision * std::abs(next);
    rho = next;
    if (settled) break;
    const Real s = slope(phi, rho);
    if (s < 0) {
      low = rho;
      slope_low = s;
      if (side == -1) slope_high /= 2;
      side = -1;
    } else {
      high = rho;
      slope_high = s;
      if (side == 1) slope_low /= 2;
      side = 1;
    }
  }
  return rho;
}

}  // namespace frictioncg
