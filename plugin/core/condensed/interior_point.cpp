#include "condensed/interior_point.h"

#include "factorization.h"
#include "model/law.h"

namespace frictioncg {

namespace {

/// Of the start, y = (K + shift)^{-1} (f + shift gap): at 1 to 1e-2 a beam takes four times the
/// steps that it takes at 1e-6, at 1e-10 a quarter more.
constexpr Real first_shift = 1e-6;
/// A gap is out of reach beyond so many times what the body moves in such springs. Those to far
/// places would pull a slender body along, and the products there hide all others.
constexpr Real far = 100;
constexpr Real proximal = 1e-8;   ///< stiffness against the step of a dof without a law, over D
constexpr Real far_enough = 1.5;  ///< times the largest negative entry that the start adds
/// Of the way to the nearest bound at most all but this share, and all but the share of the mean
/// product that is left: steps that stop at 0.99 gain two digits, however near the end is.
constexpr Real least_distance = 0.01;
/// Fall of the mean product at which the branches show: at 1e-10 one random scene in 15 does not
/// end on them, at 1e-12 one in 300.
constexpr Real far_down = 1e-13;
constexpr int patience = 12;       ///< steps in which the mean product must halve
constexpr Index most_steps = 60;   ///< slender bodies take up to 20
constexpr Real stuck_step = 1e-8;  ///< a step that leads nowhere

/// The positive part a that keeps h + a dh > |v + a dv|, the root of
///   h^2 - |v|^2 + 2 a (h dh - v.dv) + a^2 (dh^2 - |dv|^2) = 0.
Real room_in_cone(Real h, const Tangent& v, Real dh, const Tangent& dv) {
  const Real c = h * h - v.squaredNorm(), b = h * dh - v.dot(dv), q = dh * dh - dv.squaredNorm(),
             discriminant = b * b - q * c;
  Real room = dh < 0 ? -h / dh : infinity;
  if (discriminant < 0) return room;
  const Real w = -(b + std::copysign(std::sqrt(discriminant), b));
  for (const Real a : {w / q, c / w})
    if (a > 0) room = std::min(room, a);
  return room;
}

/// K = D^{-1/2} S D^{-1/2}, dense.
class DensePathMatrix final : public PathMatrix {
 public:
  explicit DensePathMatrix(const CondensedProblem& problem) : laws_(problem.laws) {
    const Vector inverse = problem.D.cwiseSqrt().cwiseInverse();
    K_ = inverse.asDiagonal() * problem.S * inverse.asDiagonal();
    K_.diagonal().array() += problem.springs;
  }

  Vector multiply(const Vector& y) const override { return K_ * y; }

  bool factor(const PathLaws& laws) override {
    symmetric_ = laws.symmetric;
    M_ = K_;
    for (Index i = 0; i < laws_.nodes(); ++i) {
      const Index N = laws_.system->first[i] - laws_.interior(), size = laws_.tangents(i) + 1;
      M_.block(N, N, size, size) += laws.blocks[i];
    }
    if (!(M_.diagonal().minCoeff() > 0) || !M_.allFinite()) return false;
    scale_ = M_.diagonal().cwiseSqrt().cwiseInverse();
    M_ = scale_.asDiagonal() * M_ * scale_.asDiagonal();
    if (symmetric_) return llt_.emplace(M_).found();
    single_.reset();
    if (M_.rows() >= single_pays && !fine_)
      single_ = std::make_unique<const SinglePrecision>(M_);
    else
      lu_.emplace(M_);
    return true;
  }

  Vector solve(const Vector& b) override {
    const Vector scaled = scale_.cwiseProduct(b);
    if (symmetric_) return scale_.cwiseProduct(llt_->solve(scaled));
    if (single_) {
      const Vector y = single_->solve(scaled);
      if (y.size() > 0) return scale_.cwiseProduct(y);
      fine_ = true;
      single_.reset();
      lu_.emplace(M_);
    }
    return scale_.cwiseProduct(lu_->solve(scaled));
  }

 private:
  const ContactProblem& laws_;
  DenseMatrix K_, M_;
  Vector scale_;  ///< of M, D^{-1/2}
  bool symmetric_ = true;
  std::optional<Cholesky> llt_;  ///< in M, as are lu and, beside it, single
  std::optional<LU> lu_;
  std::unique_ptr<const SinglePrecision> single_;
  bool fine_ = false;  ///< single precision does not do any more
};

}  // namespace

CentralPath::CentralPath(const CondensedProblem& problem)
    : CentralPath(problem.laws, std::make_unique<DensePathMatrix>(problem), problem.f, problem.D,
                  problem.observer) {}

CentralPath::CentralPath(const ContactProblem& laws, std::unique_ptr<PathMatrix> K, const Vector& f,
                         const Vector& D, Observer* observer)
    : problem_(laws),
      K_(std::move(K)),
      observer_(observer),
      nodes_(laws.nodes()),
      offset_(laws.dofs() - static_cast<Index>(f.size())),
      unit_(D.cwiseSqrt()),
      f_(f.cwiseQuotient(unit_)),
      gap_(Vector::Zero(nodes_)),
      mu_(gap_),
      g_(gap_),
      cap_(Vector::Constant(nodes_, infinity)),
      closes_(nodes_, 0),
      rubs_(nodes_, 0) {
  const Increment& increment = laws.increment;
  for (Index i = 0; i < nodes_; ++i) {
    const Index N = normal(i);
    const NodeLaw law = law_of(increment, i);
    closes_[i] = std::isfinite(increment.gap[i]);
    if (closes_[i]) gap_[i] = increment.gap[i] * unit_[N];
    if (tangents(i) == 0 || !law.has_friction()) continue;
    g_[i] = (closes_[i] ? law.c : law.open_limit()) / unit_[N + 1];
    cap_[i] = law.cap / unit_[N + 1];
    if (closes_[i]) mu_[i] = law.mu * unit_[N] / unit_[N + 1];
    rubs_[i] = closes_[i] || g_[i] > 0;
    symmetric_ = symmetric_ && !rubs_[i];
  }
  true_gap_ = gap_;
}

/// Near the least of the energy, where every node sees a weak spring to its gap.
bool CentralPath::start() {
  PathLaws springs;
  for (Index i = 0; i < nodes_; ++i)
    springs.blocks.push_back(first_shift * NodeBlock::Identity(tangents(i) + 1, tangents(i) + 1));
  if (!K_->factor(springs)) return false;
  if (first_ == 0) bring_near();
  at_.y = pulled_to(gap_);
  at_.s = at_.t = Vector::Zero(nodes_);
  at_.r = Vector::Zero(at_.y.size());
  make_positive();
  const Real tau = mean_product(at_);
  for (Index i = 0; i < nodes_; ++i) {
    if (!rubs_[i]) continue;
    const Index T = normal(i) + 1, d = tangents(i);
    const Real g = limit(i, at_), slip = at_.y.segment(T, d).norm();
    at_.t[i] = std::hypot(slip, tau / g);
    at_.r.segment(T, d) = 0.5 * g / at_.t[i] * at_.y.segment(T, d);
  }
  return at_.y.allFinite() && at_.t.allFinite();
}

/// y where springs pull the nodes to such gaps.
Vector CentralPath::pulled_to(const Vector& gap) const {
  Vector b = f_;
  for (Index i = 0; i < nodes_; ++i) b[normal(i)] += first_shift * gap[i];
  return K_->solve(b);
}

/// Takes nearer gaps, which nothing reaches either, for those out of reach.
void CentralPath::bring_near() {
  Real nearest = infinity, farthest = 0;
  for (Index i = 0; i < nodes_; ++i) {
    if (!closes_[i]) continue;
    nearest = std::min(nearest, std::abs(gap_[i]));
    farthest = std::max(farthest, gap_[i]);
  }
  if (farthest <= far * nearest) return;
  const Vector y = pulled_to(gap_.cwiseMin(nearest));
  Real reach = nearest;
  for (Index i = 0; i < nodes_; ++i)
    if (closes_[i]) reach = std::max({reach, std::abs(y[normal(i)]), -gap_[i]});
  gap_ = gap_.cwiseMin(far * reach);
}

/// Where a gap that was taken for a nearer one is reached after all: another one, if need be the
/// true one. False where none is.
bool CentralPath::bring_further() {
  Real reach = 0;
  bool reached = false;
  for (Index i = 0; i < nodes_; ++i) {
    if (!closes_[i]) continue;
    reach = std::max(reach, std::abs(at_.y[normal(i)]));
    reached = reached || (gap_[i] < true_gap_[i] && at_.y[normal(i)] > gap_[i] / 2);
  }
  if (reached) gap_ = true_gap_.cwiseMin(far * reach);
  return reached;
}

/// s and r_N from y, shifted to where both are positive and their products alike.
void CentralPath::make_positive() {
  const auto closing = [&](auto&& visit) {
    for (Index i = 0; i < nodes_; ++i)
      if (closes_[i]) visit(at_.s[i], at_.r[normal(i)], i);
  };
  Real least_s = 0, least_N = 0, sum_s = 0, sum_N = 0, product = 0;
  closing([&](Real& s, Real& N, Index i) {
    s = gap_[i] - at_.y[normal(i)];
    N = -first_shift * s;
    least_s = std::min(least_s, s);
    least_N = std::min(least_N, N);
  });
  closing([&](Real& s, Real& N, Index) {
    sum_s += s -= far_enough * least_s;
    sum_N += N -= far_enough * least_N;
    product += s * N;
  });
  const Real more_s = product > 0 ? product / sum_N / 2 : 1,
             more_N = product > 0 ? product / sum_s / 2 : 1;
  closing([&](Real& s, Real& N, Index) {
    s += more_s;
    N += more_N;
  });
}

/// tau of the nearest point of the path: the mean of s r_N and of g t - r_T.x_T.
Real CentralPath::mean_product(const Point& p) const {
  Real sum = 0;
  Index count = 0;
  for (Index i = 0; i < nodes_; ++i) {
    const Index N = normal(i), d = tangents(i);
    if (closes_[i]) sum += p.s[i] * p.r[N], ++count;
    if (!rubs_[i] || p.t[i] == 0) continue;
    sum += limit(i, p) * p.t[i] - p.r.segment(N + 1, d).dot(p.y.segment(N + 1, d));
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

/// The laws of all nodes, linear in dy, for a target tau; before: the predictor, whose products
/// they take into account.
void CentralPath::linearize(Real tau, const Point* before) {
  laws_.resize(nodes_);
  for (Index i = 0; i < nodes_; ++i) {
    const Index N = normal(i), size = tangents(i) + 1;
    laws_[i] = {NodeVector::Zero(size), NodeBlock::Zero(size, size)};
    if (closes_[i]) {
      // s dr + r ds = tau - s r,  ds = (gap - y - s) - dy
      const Real s = at_.s[i], r = at_.r[N], left = gap_[i] - at_.y[N] - s;
      const Real rest = tau - s * r - (before ? before->s[i] * before->r[N] : 0);
      laws_[i].c[0] = (rest - r * left) / s;
      laws_[i].M(0, 0) = r / s;
    }
    if (rubs_[i]) linearize_friction(i, tau, before);
  }
}

/// With r = r_T, x = x_T, and dg = mu dN:
///   g dt + t dg - r.dx - x.dr = tau - (g t - r.x)
///   t dr + r dt - g dx - x dg = -(t r - g x)
/// dt from the first, in the second:
///   (t I + r x'/g) dr = c - r c_t/g + (g I - r r'/g) dx + (x + r t/g) slope dN
/// and dN from the law of contact.
void CentralPath::linearize_friction(Index i, Real tau, const Point* before) {
  const Index T = normal(i) + 1, d = tangents(i);
  using TangentBlock = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, 2, 2>;
  const Tangent r = at_.r.segment(T, d), x = at_.y.segment(T, d);
  const Real g = limit(i, at_), t = at_.t[i];
  Linear& law = laws_[i];
  law.rest = tau - g * t + r.dot(x);
  Tangent c = g * x - t * r;
  if (before) {
    const Tangent dr = before->r.segment(T, d), dx = before->y.segment(T, d);
    const Real dg = slope(i) * before->r[T - 1];
    law.rest -= dg * before->t[i] - dr.dot(dx);
    c -= before->t[i] * dr - dg * dx;
  }
  const TangentBlock I = TangentBlock::Identity(d, d);
  const TangentBlock inverse = (I - r * x.transpose() / (g * t + r.dot(x))) / t;
  const Tangent by_normal = inverse * (x + r * (t / g)) * slope(i);
  law.c.tail(d) = inverse * (c - r * (law.rest / g)) + by_normal * law.c[0];
  law.M.col(0).tail(d) = by_normal * law.M(0, 0);
  law.M.bottomRightCorner(d, d) = inverse * (g * I - r * r.transpose() / g);
}

/// M = K + what the laws add; false where it cannot be factored.
bool CentralPath::factor() {
  PathLaws laws{{}, symmetric_};
  for (Index i = 0; i < nodes_; ++i) {
    laws.blocks.push_back(laws_[i].M);
    auto diagonal = laws.blocks[i].diagonal();
    if (!closes_[i]) diagonal[0] = proximal;
    if (!rubs_[i]) diagonal.tail(tangents(i)).setConstant(proximal);
  }
  return K_->factor(laws);
}

/// The step of the linear laws.
CentralPath::Point CentralPath::step() {
  Point d;
  Vector b = f_ - K_->multiply(at_.y) - at_.r;
  for (Index i = 0; i < nodes_; ++i) b.segment(normal(i), tangents(i) + 1) -= laws_[i].c;
  d.y = K_->solve(b);
  d.s = d.t = Vector::Zero(nodes_);
  d.r = Vector::Zero(b.size());
  for (Index i = 0; i < nodes_; ++i) {
    const Linear& law = laws_[i];
    const Index N = normal(i), T = N + 1, k = tangents(i);
    d.r.segment(N, k + 1) = law.c + law.M * d.y.segment(N, k + 1);
    if (closes_[i]) d.s[i] = gap_[i] - at_.y[N] - at_.s[i] - d.y[N];
    if (!rubs_[i]) continue;
    const Real work =
        at_.r.segment(T, k).dot(d.y.segment(T, k)) + at_.y.segment(T, k).dot(d.r.segment(T, k));
    d.t[i] = (law.rest - at_.t[i] * slope(i) * d.r[N] + work) / limit(i, at_);
  }
  return d;
}

/// How far d may be followed.
Real CentralPath::room(const Point& d) const {
  Real room = infinity;
  for (Index i = 0; i < nodes_; ++i) {
    const Index N = normal(i), T = N + 1, k = tangents(i);
    if (closes_[i] && d.s[i] < 0) room = std::min(room, -at_.s[i] / d.s[i]);
    if (closes_[i] && d.r[N] < 0) room = std::min(room, -at_.r[N] / d.r[N]);
    if (!rubs_[i]) continue;
    room = std::min(
        {room,
         room_in_cone(limit(i, at_), at_.r.segment(T, k), slope(i) * d.r[N], d.r.segment(T, k)),
         room_in_cone(at_.t[i], at_.y.segment(T, k), d.t[i], d.y.segment(T, k))});
  }
  return room;
}

/// A step takes the limit for linear: where its cap turns it down, shear beyond it is cut off.
void CentralPath::cut_shear() {
  for (Index i = 0; i < nodes_; ++i) {
    if (!rubs_[i] || !std::isfinite(cap_[i])) continue;
    auto shear = at_.r.segment(normal(i) + 1, tangents(i));
    const Real most = limit(i, at_), size = shear.norm();
    if (size >= most) shear *= (1 - least_distance) * most / size;
  }
}

void CentralPath::move(Point& p, const Point& d, Real part) const {
  p.y += part * d.y;
  p.r += part * d.r;
  p.s += part * d.s;
  p.t += part * d.t;
}

Index CentralPath::follow(Index max_steps) {
  if (problem_.increment.bilateral) return 0;
  Index steps = 0;
  do {
    if (!start()) return 0;
    first_ = mean_product(at_);
    steps += follow_to(far_down * first_, std::min(max_steps - steps, most_steps));
  } while (steps < max_steps && bring_further());
  return steps;
}

Index CentralPath::go_on(Index max_steps) {
  const Vector end = at_.y;
  const Index steps = follow_to(0, std::min(max_steps, most_steps));
  return at_.y == end ? 0 : steps;
}

Index CentralPath::follow_to(Real goal, Index most) {
  Real mark = mean_product(at_);
  Index steps = 0;
  while (steps < most) {
    const Real mean = mean_product(at_);
    if (mean <= goal) break;
    if (steps > 0 && steps % patience == 0) {
      if (!(mean <= 0.5 * mark)) break;
      mark = mean;
    }
    ++steps;
    if (observer_) observer_->step(Work::interior_point, mean / first_);
    linearize(0, nullptr);
    if (!factor()) break;
    const Point predictor = step();
    Point ahead = at_;
    move(ahead, predictor, std::min<Real>(1, room(predictor)));
    const Real falls_to = std::max<Real>(mean_product(ahead) / mean, 0);
    linearize(std::min<Real>(std::pow(falls_to, 3), 1) * mean, &predictor);
    const Point d = step();
    const Real of_room = 1 - std::min(least_distance, mean / first_);
    const Real part = std::min<Real>(1, of_room * room(d));
    if (!d.y.allFinite() || !(part > stuck_step)) break;
    move(at_, d, part);
    cut_shear();
  }
  return steps;
}

/// Where the start is far out, as of soft bodies beside stiff ones, the branches show later.
Attempt by_interior_point(const CondensedProblem& problem, Index max_steps) {
  Attempt a;
  CentralPath path(problem);
  a.steps = path.follow(max_steps);
  if (a.steps == 0 || path.stalled()) return a;
  a.solved = newton_from(path.x(), problem, max_steps, a);
  if (a.solved) return a;
  const Index more = path.go_on(max_steps - a.steps);
  if (more == 0) return a;
  a.steps += more;
  a.solved = newton_from(path.x(), problem, max_steps, a);
  return a;
}

}  // namespace frictioncg
