#include "condensed/semismooth_newton.h"

#include "factorization.h"
#include "linear_algebra.h"
#include "model/certificate.h"
#include "model/proximal_springs.h"

namespace frictioncg {

namespace {
constexpr Real singular = 1e-13;  ///< reciprocal condition number at which a motion counts as free
constexpr Real rounding_margin = 100;  ///< S carries what the elimination has left
constexpr Real solved = 1e-12;         ///< residual at which a node that grazes is on either branch
constexpr Real settled = 1e-9;         ///< residual that may be rounding, once the branches stay
constexpr int most_stalled = 8;        ///< 3D: directions of slip may need some steps to settle
/// Of the load: what fields that ran away violate is 3e-3 of it and more, and 3e-8 where a column
/// is about to buckle.
constexpr Real hardly_anything = 1e-6;
constexpr Real least_tangential = 1e-6;  ///< of diag(S) over D: a body on one node has S = 0
constexpr Real progress = 0.5;   ///< of the residual from step to step, on the same branches
constexpr Real standing = 1e-6;  ///< a residual that changes by less has no direction to settle
/// Of the forces that violate the laws, over those of the first step. From stick they fall where
/// Newton's method arrives; in slender bodies, whose bending makes large forces of small
/// corrections, they doubled within four steps, and it cycled after up to 40.
constexpr Real runaway = 2;
constexpr Index settling = 4;  ///< steps before that, in which they may grow all the same
}  // namespace

SemismoothNewton::SemismoothNewton(const CondensedProblem& problem)
    : problem_(problem),
      c_(problem.laws.nodes()),
      branch_(all_stick(problem.laws.increment)),
      x_(Vector::Zero(problem.f.size())) {
  const Real share = wave_share(*problem.laws.system);
  for (Index i = 0; i < problem.laws.nodes(); ++i) {
    const Index T = problem.normal(i) + 1, t = problem.laws.tangents(i);
    if (t == 0) continue;
    const Real least = least_tangential * problem.D.segment(T, t).mean();
    c_[i] = share * std::max(problem.S.diagonal().segment(T, t).mean(), least);
  }
}

void SemismoothNewton::start_from(const Branches& branches) {
  branch_ = branches;
  from_stick_ = false;
}

void SemismoothNewton::start_from(const Vector& x) {
  from_stick_ = false;
  x_ = x;
  r_ = problem_.residual(x);
  choose_branches();
}

SemismoothNewton::Outcome SemismoothNewton::solve(Index max_steps) {
  std::set<std::size_t> seen{fingerprint()};
  Real best = infinity, first = best;
  int stalled = 0;  // steps on the same branches without progress; 2D: the next one is the same
  for (steps_ = 0; steps_ < max_steps;) {
    ++steps_;
    if (!step()) return Outcome::singular;
    r_ = problem_.residual(x_);
    // with c = diag(A): a small algorithmic c would flatter it
    const Violation v = violation(problem_.laws, problem_.D, x_, r_);
    const Real forces = std::sqrt(v.normal + v.friction);
    const Real last = residual_;
    residual_ = forces / unit();
    if (problem_.observer)
      problem_.observer->step(problem_.springs > 0 ? Work::proximal : Work::newton, residual_);
    if (steps_ == 1) first = forces;
    if (from_stick_ && steps_ >= settling && forces > runaway * first) return Outcome::ran_away;
    const std::size_t before = fingerprint();
    choose_branches();
    const std::size_t after = fingerprint();
    if (residual_ <= solved) return Outcome::converged;
    if (after == before && residual_ > progress * best) {
      if (residual_ < std::max(settled, ran_away() ? 0 : rounding())) return Outcome::converged;
      const bool stands = std::abs(residual_ - last) <= standing * residual_;
      if (problem_.laws.system->dimension == 2 || stands || ++stalled > most_stalled)
        return Outcome::stalled;
    }
    best = std::min(best, residual_);
    if (after != before && !seen.insert(after).second) return Outcome::cycled;
  }
  return Outcome::exhausted;
}

/// Branches of the laws at (x, r), r = f - Sx.
void SemismoothNewton::choose_branches() {
  const ContactProblem& laws = problem_.laws;
  for (Index i = 0; i < laws.nodes(); ++i) {
    const Index N = problem_.normal(i), size = laws.tangents(i) + 1;
    const Real closing = problem_.D[N] * (laws.increment.gap[i] - x_[N]);
    const NodeLaw law = law_of(laws.increment, i);
    const auto x = x_.segment(N, size), r = r_.segment(N, size);
    branch_[i] = branch_at(law, closing, x, r, c_[i]);
    branch_[i].choose_touch(law, closing, x, r, c_[i]);
  }
}

/// x := solution of the linear system of the present branches; false where it is singular.
bool SemismoothNewton::step() {
  const ContactProblem& laws = problem_.laws;
  unknown_.clear();
  x_.setZero();
  for (Index i = 0; i < laws.nodes(); ++i) {
    const Index N = problem_.normal(i);
    if (branch_[i].closed)
      x_[N] = laws.increment.gap[i];
    else
      unknown_.push_back(N);
    if (!branch_[i].stick)
      for (Index k = 1; k <= laws.tangents(i); ++k) unknown_.push_back(N + k);
  }
  rhs_ = x_.isZero(0) ? problem_.f : problem_.residual(x_);
  undetermined_ = positive_ = false;
  if (unknown_.empty()) return true;
  const Vector solution = solve_branches();
  if (!solution.allFinite()) return false;
  for (Index p = 0; p < solution.size(); ++p) x_[unknown_[p]] = solution[p];
  return true;
}

/// M and b of the unknowns on the present branches, rows and columns scaled by D^{-1/2}. True where
/// M is symmetric.
bool SemismoothNewton::assemble() {
  const ContactProblem& laws = problem_.laws;
  const DenseMatrix& S = problem_.S;
  const Index size = static_cast<Index>(unknown_.size());
  if (size != b_.size()) {  // Eigen's resize frees what it holds once more where memory runs out
    for (Vector* v : {&b_, &scale_, &factor_}) *v = Vector();
    M_ = DenseMatrix();
  }
  b_.resize(size);
  scale_.resize(size);
  factor_.setZero(size);
  normal_.assign(size, 0);
  for (Index p = 0; p < size; ++p) {
    b_[p] = rhs_[unknown_[p]];
    scale_[p] = 1 / std::sqrt(problem_.D[unknown_[p]]);
  }
  // rows of slip: r_T = factor r_N + base d + ...
  for_each_slip([&](const Branch& n, Index i, Index p, Index t) {
    const Branch::Limit limit = n.limit(law_of(laws.increment, i));
    for (Index k = 0; k < t; ++k) {
      factor_[p + k] = limit.slope * n.d[k];
      normal_[p + k] = problem_.normal(i);
      b_[p + k] -= factor_[p + k] * rhs_[normal_[p + k]] + limit.base * n.d[k];
    }
  });
  M_.resize(size, size);
  for (Index q = 0; q < size; ++q) {
    const auto column = S.col(unknown_[q]);
    for (Index p = 0; p < size; ++p)
      M_(p, q) = scale_[p] * scale_[q] * (column[unknown_[p]] - factor_[p] * column[normal_[p]]);
  }
  M_.diagonal().array() += problem_.springs;  // a slip row refers to normals that are no unknowns
  for_each_slip([&](const Branch& n, Index, Index p, Index t) {
    const Eigen::Matrix2d W = n.stiffness();
    for (Index k = 0; k < t; ++k)
      for (Index l = 0; l < t; ++l) M_(p + k, p + l) += scale_[p + k] * scale_[p + l] * W(k, l);
  });
  b_.array() *= scale_.array();
  return factor_.isZero(0);
}

/// Visits the nodes whose tangential dofs are unknowns: branch, node, first of those unknowns,
/// number.
template <class Visit>
void SemismoothNewton::for_each_slip(Visit visit) const {
  for (Index i = 0, p = 0; i < problem_.laws.nodes(); ++i) {
    const Branch& n = branch_[i];
    const Index t = problem_.laws.tangents(i);
    if (!n.closed) ++p;
    if (n.stick || t == 0) continue;
    visit(n, i, p, t);
    p += t;
  }
}

/// The unknowns, by a factorization in place of M. Where the branches leave a rigid motion free,
/// the solution of least norm: the load may be in balance with it.
Vector SemismoothNewton::solve_branches() {
  if (assemble()) {
    const Cholesky llt(M_);
    positive_ = llt.found() && problem_.springs == 0;
    if (llt.found() && llt.rcond() > singular) return scale_.asDiagonal() * llt.solve(b_);
  } else {
    if (b_.size() >= single_pays) {
      const Vector y = SinglePrecision(M_).solve(b_);
      if (y.size() > 0) return scale_.asDiagonal() * y;
    }
    const LU lu(M_);
    if (lu.rcond() > singular) return scale_.asDiagonal() * lu.solve(b_);
  }
  assemble();
  undetermined_ = true;
  return scale_.asDiagonal() * least_squares(M_, b_, singular);
}

/// The forces at work, in norm_D; where there are none, the total load.
Real SemismoothNewton::unit() const {
  const Increment& increment = problem_.laws.increment;
  Real contact = 0;
  for (Index i = 0; i < problem_.laws.nodes(); ++i) {
    const Index N = problem_.normal(i), size = problem_.laws.tangents(i) + 1;
    if (!branch_[i].closed) continue;
    contact += (r_.segment(N, size).array().square() / problem_.D.segment(N, size).array()).sum();
  }
  const Real load = increment.load_that_counts(increment.rounding);
  const Real work = forces_at_work(load, std::sqrt(contact));
  return work > 0 ? work : increment.force_scale;
}

/// Whether a motion that the branches leave all but free has carried x so far off that rounding
/// hides violations of the laws which are no little share of the load.
bool SemismoothNewton::ran_away() const {
  return undetermined_ &&
         residual_ * unit() > hardly_anything * problem_.laws.increment.force_scale;
}

/// What S x cannot resolve of the residual, in the same units.
Real SemismoothNewton::rounding() const {
  const Real size = std::sqrt((problem_.D.array() * x_.array().square()).sum());
  return rounding_margin * epsilon * size / unit();
}

std::size_t SemismoothNewton::fingerprint() const {
  std::size_t hash = 1469598103934665603u;
  for (const Branch& b : branch_) {
    // directions in 3D converge; only which branch, and in 2D the sense, can cycle
    const std::size_t sense =
        problem_.laws.system->dimension == 2 && !b.stick ? 1 + (b.d[0] > 0) : 0;
    hash = (hash ^ (b.closed + 2 * b.stick + 4 * sense + 16 * b.capped + 32 * b.touching)) *
           1099511628211u;
  }
  return hash;
}

namespace {

constexpr Index newton_steps = 40;  ///< where it arrives it takes 15; beyond 40 it cycles

/// The first springs are as stiff as D, a node on its own; the weakest are near the rounding of D.
constexpr Real first_springs = 1, weakest_springs = 1e-10;
/// Newton's method is tried without springs once they are as weak as this.
constexpr Real weak_springs = 1e-2;
/// Where springs as stiff as this do not help, nothing does.
constexpr Real strongest_springs = 100;
/// Bodies that were held took up to 150 steps.
constexpr Index most_newton_steps = 400;
/// A body on which springs, however soft, pull from point to point by so much of the last pull and
/// more is one that nothing has met yet: Newton's method without them would not arrive. After so
/// many points of the softest springs nothing will meet it.
constexpr Real unslowed = 0.9;
constexpr Index most_unslowed = 3;

}  // namespace

bool newton_from(const Vector& x, const CondensedProblem& problem, Index max_steps, Attempt& a,
                 const Branches& given) {
  SemismoothNewton newton(problem);
  if (x.size() > 0)
    newton.start_from(x);
  else if (!given.empty())
    newton.start_from(given);
  const Index bound = std::min(newton_steps, max_steps - a.steps);
  const bool solved = newton.solve(bound) == SemismoothNewton::Outcome::converged;
  a.steps += newton.steps();
  if (!solved) {
    if (a.steps >= max_steps) a.status = Status::max_iterations;
    return false;
  }
  a.x = newton.x();
  a.branches = newton.branches();
  a.undetermined = newton.undetermined();
  a.positive = newton.positive();
  return true;
}

Attempt by_proximal_points(const CondensedProblem& problem, Index max_steps) {
  Attempt a;
  max_steps = std::min(max_steps, most_newton_steps);
  CondensedProblem sprung = problem;
  ProximalSprings springs(first_springs, weakest_springs);
  Real last_pull = infinity;
  Index creeping = 0;
  while (a.steps < max_steps && springs.eps() <= strongest_springs && creeping < most_unslowed) {
    const Vector last = a.x;
    sprung.springs = springs.eps();
    sprung.f = problem.f;
    if (a.x.size() > 0) sprung.f.array() += sprung.springs * problem.D.array() * a.x.array();
    if (newton_from(a.x, sprung, max_steps, a)) {
      const Real pull = last.size() > 0 ? springs.eps() * (a.x - last).norm() : infinity;
      const bool slows = pull <= unslowed * last_pull;
      creeping = springs.softest() && !slows ? creeping + 1 : 0;
      last_pull = pull;
      if (springs.eps() <= weak_springs && (slows || creeping == 1))
        a.solved = newton_from(a.x, problem, max_steps, a);
      if (a.solved) return a;
      springs.found();
    } else {
      springs.missed();
    }
  }
  return a;
}

}  // namespace frictioncg
