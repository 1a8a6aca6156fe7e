#include "condensed/condensed.h"

#include "clock.h"
#include "condensed/bounded_pressure.h"
#include "condensed/interior_point.h"
#include "condensed/limits.h"
#include "statics/rigid_motions.h"
#include "statics/undetermined.h"
#include "statics/floating.h"
#include "factorization.h"
#include "linear_algebra.h"
#include "threads.h"

namespace frictioncg {

namespace {

constexpr int passes = 4;    ///< of the refinement: each gains the digits that S has
constexpr Real worth = 0.3;  ///< a pass that reduces the residual less is the last

}  // namespace

Vector CondensedProblem::residual(const Vector& x) const {
  Vector r = f;
  r.noalias() -= S * x;
  if (springs > 0) r.array() -= springs * D.array() * x.array();
  return r;
}

ContactProblem CondensedProblem::on_contact_dofs() const {
  const System& whole = *laws.system;
  const auto s = std::make_shared<AssembledSystem>();
  s->dimension = whole.dimension;
  for (Index first : whole.first) s->first.push_back(first - whole.interior());
  s->A = S.sparseView(0, 0);
  s->D = S.diagonal();
  s->weight = D;  // of A: one certificate, there and here
  ContactProblem p{s, laws.increment};
  p.increment.F = f;
  return p;
}

/// One call: what its layers share, and the field as it is refined.
struct CondensedSolver::Run {
  const ContactProblem& problem;
  const Settings& settings;
  Observer* const observer;
  const PathOnA& path;
  const Index bound;                                  ///< on all iterations
  Vector x = Vector::Zero(problem.dofs());            ///< n
  Vector r = problem.increment.F;                     ///< n, F - Ax: the next pass solves for it
  Vector x_C = Vector::Zero(problem.contact_dofs());  ///< of x
  Solution s = {};                                    ///< the best so far
  Real best = infinity;
  bool undetermined = false;  ///< s.x is the least of several
  bool positive = false;      ///< A is known to have no negative energy at s.x
  bool asked = false;         ///< whether the load can be held
  DenseMatrix rigid = {};     ///< n x k, found where it was asked for

  Index left() const { return bound - s.iterations; }
};

Solution CondensedSolver::solve(const Request& request, const PathOnA& path) {
  const auto& [problem, settings, x0, observer] = request;
  Run run{problem, settings, observer, path, request.bound()};
  const Threads threads(elimination_.threads_pay());
  Solution& s = run.s;
  s.route = Route::condensed;
  if (unheld(run, unheld_motion(elimination_.floating(), problem)))
    s.status = Status::no_equilibrium;
  else
    refine(run, x0.size() > 0 ? Vector(x0.tail(problem.contact_dofs())) : Vector());
  if (s.x.size() == 0) {
    s.x = Vector::Zero(problem.dofs());
    s.certificate = certify(problem, s.x);
  }
  const bool may_pass = s.status == Status::converged ||
                        (s.status != Status::no_equilibrium && may_be_rounding(s.certificate));
  if (may_pass && !run.positive) look_for_negative_energy(problem, s);
  if (s.status != Status::no_equilibrium) settle(run);
  s.times += elimination_.take_times();
  return std::move(run.s);
}

/// The laws, inside iterative refinement of the equilibrium: the first pass has r = F.
void CondensedSolver::refine(Run& run, Vector start) {
  for (int pass = 0; pass < passes; ++pass) {
    const Real before = run.best;
    const Attempt a = solve_laws(run, condense(run), start);
    recover(run, a);
    start = run.x_C;
    if (run.best <= run.settings.tol || run.best > worth * before || !a.solved) break;
  }
  if (run.best <= run.settings.tol)
    run.s.status = Status::converged;
  else if (run.s.status == Status::converged)
    run.s.status = Status::stagnated;
  if (run.best > run.settings.tol) last_.clear();
}

/// The laws see the whole x_C, but only the load that x does not carry yet:  f = f(r) + S x_C.
CondensedProblem CondensedSolver::condense(Run& run) {
  const Stopwatch watch(run.s.times.back_substitution);
  CondensedProblem condensed{elimination_.S(), elimination_.condense(run.r),
                             run.problem.system->weight.tail(run.x_C.size()), run.problem};
  condensed.observer = run.observer;
  if (!run.x_C.isZero(0)) condensed.f.noalias() += elimination_.S() * run.x_C;
  return condensed;
}

/// The field of an answer on the load that was condensed last: one answer each.
void CondensedSolver::recover(Run& run, const Attempt& a) {
  Solution& s = run.s;
  if (a.x.size() != run.x_C.size() || !a.x.allFinite()) {
    s.status = a.status;
    return;
  }
  {
    const Stopwatch watch(s.times.back_substitution);
    run.x += elimination_.recover(a.x - run.x_C);
    run.x_C = a.x;
  }
  run.r = keep_if_better(run, run.x, a);
}

/// x, where it is the best so far; its residual F - Ax.
Vector CondensedSolver::keep_if_better(Run& run, const Vector& x, const Attempt& a) {
  Solution& s = run.s;
  const Stopwatch watch(s.times.certificate);
  Certificate certificate = certify(run.problem, x);
  if (!(certificate.residual < run.best)) return std::move(certificate.r);
  run.best = certificate.residual;
  run.undetermined = a.undetermined;
  run.positive = a.positive;
  s.x = x;
  s.status = a.solved ? Status::converged : a.status;
  s.certificate = std::move(certificate);
  return s.certificate.r;
}

/// Newton's method; where it does not arrive, first whether the load can be held at all, then an
/// interior point, then springs that vanish, then one sliding limit after the other.
Attempt CondensedSolver::solve_laws(Run& run, const CondensedProblem& condensed,
                                    const Vector& start) {
  Solution& s = run.s;
  const Stopwatch watch(s.times.contact);
  Attempt a;
  const auto answered = [&](Layer layer) {
    if (s.layer == Layer::none) s.layer = layer;
    if (a.branches.size() > 0) last_ = a.branches;
    return a;
  };
  if (run.problem.nodes() == 0) {  // a linear solve
    a.x = run.x_C;
    a.solved = true;
    return answered(Layer::linear);
  }
  if (!run.settings.newton) {
    a = by_gradient(run, condensed, start);
    return answered(Layer::fixed_point);
  }
  a = by_newton(run, condensed, start);
  s.iterations += a.steps;
  if (a.solved) return answered(Layer::newton);
  if (!run.asked && unheld_by_anything(run, condensed)) {
    a.status = Status::no_equilibrium;
    return a;
  }
  run.asked = true;
  if (const auto on_A = run.path ? run.path(run.left()) : std::nullopt) {
    s.iterations += on_A->iterations;
    a.x = on_A->x.tail(condensed.f.size());
    a.solved = on_A->status == Status::converged;
    a.undetermined = true;  // it may be: the path does not tell
    if (a.solved) return answered(Layer::sparse_interior_point);
    a.status = on_A->status;
    keep_if_better(run, on_A->x, a);  // what comes next may be further away
    if (run.best <= s.certificate.attainable) return answered(Layer::sparse_interior_point);
  } else {
    a = by_interior_point(condensed, run.left());
    s.iterations += a.steps;
    if (a.solved) return answered(Layer::interior_point);
  }
  a = by_proximal_points(condensed, run.left());
  s.iterations += a.steps;
  if (a.solved) return answered(Layer::proximal);
  Attempt last = by_limits(condensed, what_remains(run.problem, run.settings, s));
  s.iterations += last.steps;
  if (last.solved) {
    a = last;
    return answered(Layer::limits);
  }
  // what ended a layer says nothing about the bound of the call
  a.status = run.left() > 0 ? Status::stagnated : Status::max_iterations;
  return answered(Layer::proximal);
}

/// Newton from the branches of `start`, or from stick where the last answer was closed; where
/// neither is there, or it fails, from stick everywhere.
Attempt CondensedSolver::by_newton(const Run& run, const CondensedProblem& condensed,
                                   const Vector& start) const {
  Attempt a;
  const Branches closed = stick_where_closed(run.problem.increment, last_);
  if (start.size() > 0 || !closed.empty())
    a.solved = newton_from(start, condensed, run.left(), a, closed);
  if (!a.solved) a.solved = newton_from(Vector(), condensed, run.left(), a);
  return a;
}

/// The paper's method on S, regularized.
Attempt CondensedSolver::by_gradient(Run& run, const CondensedProblem& condensed,
                                     const Vector& start) {
  Attempt a;
  if (run.left() <= 0) {
    a.status = Status::max_iterations;
    return a;
  }
  Solution& s = run.s;
  const Settings rest = what_remains(run.problem, run.settings, s);
  const Solution smooth = by_regularization(condensed, rest, start);
  s.iterations += smooth.iterations;
  s.passes += smooth.passes;
  s.steps += smooth.steps;
  s.eps = smooth.eps;
  a.x = smooth.x;
  a.status = smooth.status;
  if (smooth.negative.size() == a.x.size()) s.negative = elimination_.extend(smooth.negative);
  a.solved = smooth.status == Status::converged;
  return a;
}

/// Whether a motion is a proof that contact and friction cannot hold the load.
bool CondensedSolver::unheld(Run& run, const std::optional<Vector>& motion) {
  if (motion) run.s.unheld_motion = *motion;
  return motion.has_value();
}

/// The same of all rigid motions, by the laws, or by the stiffness that bounds bilateral contact.
bool CondensedSolver::unheld_by_anything(Run& run, const CondensedProblem& condensed) {
  const DenseMatrix& W = rigid_motions_of_A(run);
  return unheld(run, unheld_motion(W, run.problem)) ||
         unheld(run, unheld_at_bounded_pressure(W, condensed));
}

/// The kernel of A: of its bodies, where the system knows their motions, which tells soft from
/// free; else, or where a mortar couples bodies that move on their own, what floats, and what S
/// leaves free, as far as A confirms it.
const DenseMatrix& CondensedSolver::rigid_motions_of_A(Run& run) {
  if (run.rigid.rows() > 0) return run.rigid;
  DenseMatrix known = floating_motions(*system_);
  const DenseMatrix W_C =
      rigid_motions(elimination_.S(), system_->weight.tail(system_->contact_dofs()));
  run.rigid = elimination_.floating();
  const bool all_known = known.cols() >= run.rigid.cols() + W_C.cols();
  for (Index k = 0; k < W_C.cols() && !all_known; ++k) {  // each costs a solve
    const Vector w = elimination_.extend(W_C.col(k));
    if (!costs_no_energy(*system_, w)) continue;
    run.rigid.conservativeResize(system_->dofs(), run.rigid.cols() + 1);
    run.rigid.rightCols(1) = w;
  }
  if (known.cols() > 0 && known.cols() >= run.rigid.cols()) run.rigid.swap(known);
  return run.rigid;
}

void CondensedSolver::look_for_negative_energy(const ContactProblem& problem, Solution& s) {
  const Branches branches = branches_of(problem, s.x, s.certificate);
  const Stopwatch watch(s.times.contact);
  std::vector<char> all(system_->nodes());
  for (Index k = 0; k < system_->nodes(); ++k) all[k] = !branches[k].stick;
  const Vector first = negative_energy_of(branches, all);
  for (const bool backwards : {false, true}) {
    std::vector<char> slips = all;
    Vector p = first;
    while (p.size() > 0 && hold_turning_back(branches, backwards ? Vector(-p) : p, slips))
      p = negative_energy_of(branches, slips);
    if (p.size() == 0) continue;
    s.status = Status::not_positive_definite;
    s.negative = p;
    return;
  }
}

/// A motion of open nodes, and of nodes that slip, in which A has negative energy; or empty. Where
/// A is positive definite it is so on fewer dofs.
Vector CondensedSolver::negative_energy_of(const Branches& branches,
                                           const std::vector<char>& slips) {
  std::vector<char> is_open(system_->contact_dofs(), 0);
  std::vector<Index> open;
  bool known = positive_on_.size() == is_open.size();
  for (Index k = 0; k < system_->nodes(); ++k)
    for (Index i = system_->first[k]; i < system_->first[k + 1]; ++i) {
      if (branches[k].closed && !(i > system_->first[k] && slips[k])) continue;
      open.push_back(i - system_->interior());
      is_open[open.back()] = 1;
      known = known && positive_on_[open.back()];
    }
  if (known || open.empty()) return {};
  const DenseMatrix S = elimination_.S()(open, open);
  DenseMatrix factor = S;
  const Vector of_open = Cholesky(factor).found() ? Vector() : negative_direction(S);
  if (of_open.size() > 0) {
    Vector p = Vector::Zero(system_->contact_dofs());
    p(open) = of_open;
    p = elimination_.extend(p);
    if (costs_negative_energy(*system_, p)) return p;
  }
  positive_on_ = std::move(is_open);
  return {};
}

/// Takes the nodes that p would turn back off those that slip. False where there are none, or p
/// turns all of them back: -p goes on.
bool CondensedSolver::hold_turning_back(const Branches& branches, const Vector& p,
                                        std::vector<char>& slips) const {
  constexpr Real rounding = 1e-6;
  Vector along = Vector::Zero(system_->nodes());
  for (Index k = 0; k < system_->nodes(); ++k)
    if (branches[k].closed && slips[k])
      for (Index t = 0; t < system_->tangents(k); ++t)
        along[k] += branches[k].d[t] * p[system_->first[k] + 1 + t];
  if (along.size() == 0) return false;
  const Real forward = along.maxCoeff(), back = -along.minCoeff();
  if (std::min(forward, back) <= rounding * std::max(forward, back)) return false;
  for (Index k = 0; k < system_->nodes(); ++k)
    if (along[k] < 0) slips[k] = 0;
  return true;
}

/// Takes out of x the rigid motions that nothing determines, where the laws allow it.
void CondensedSolver::settle(Run& run) {
  Solution& s = run.s;
  const Branches branches = branches_of(run.problem, s.x, s.certificate);
  if (run.undetermined || system_->border.cols() > 0 || may_be_idle(branches) ||
      between_branches(run.problem, s.x, s.certificate, branches))
    s.undetermined = left_free(rigid_motions_of_A(run), run.problem, branches);
  else
    s.undetermined = elimination_.floating();
  leave_least(run.problem, run.settings.tol, s);
}

/// Whether some body among those that can touch is held by no force at all: then stick put it where
/// it is. Nodes that S couples belong to one body.
bool CondensedSolver::may_be_idle(const Branches& branches) const {
  const DenseMatrix& S = elimination_.S();
  const Index nodes = system_->nodes(), interior = system_->interior();
  const auto place = [&](Index i) { return system_->first[i] - interior; };
  std::vector<char> seen(nodes, 0);
  for (Index i = 0; i < nodes; ++i) {
    if (seen[i]) continue;
    bool held = false;
    for (Index j = i; j < nodes; ++j) {
      const bool coupled =
          j == i ||
          !S.block(place(j), place(i), place(j + 1) - place(j), place(i + 1) - place(i)).isZero(0);
      if (!coupled) continue;
      seen[j] = 1;
      held = held || branches[j].closed || branches[j].g > 0;
    }
    if (!held) return true;
  }
  return false;
}

}  // namespace frictioncg
