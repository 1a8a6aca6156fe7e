#include "condensed/condensed.h"

#include <cmath>
#include <limits>

#include "clock.h"
#include "condensed/cholmod_elimination.h"
#include "condensed/equilibrium.h"
#include "condensed/rigid_motions.h"
#include "gradient/fixed_point.h"
#include "gradient/projected_cg.h"

namespace frictioncg {

namespace {

constexpr Index newton_steps = 40;
constexpr int refinements = 4;
constexpr Real refines = 0.3;           ///< a refinement that reduces the residual less is the last
constexpr Real least_stiffness = 1e-8;  ///< of diag(S) over diag(A)
constexpr Real rigid_field = 1e-12;     ///< <Aw,w>/<Dw,w> of a motion that is used as a proof
constexpr Real blocked = 1e-9;          ///< part of a rigid motion that a contact law forbids

/// The condensed problem in the form the conjugate gradient takes: all dofs are contact dofs.
ContactProblem on_contact_dofs(const CondensedProblem& condensed) {
  const System& whole = *condensed.laws.system;
  const auto s = std::make_shared<System>();
  s->dimension = whole.dimension;
  for (Index first : whole.first) s->first.push_back(first - whole.interior());
  s->A = condensed.S.sparseView(0, 0);
  s->A.makeCompressed();
  s->D = condensed.S.diagonal();
  s->weight = node_weights(*s);
  ContactProblem p{s, condensed.laws.increment};
  p.increment.F = condensed.f;
  return p;
}

}  // namespace

/// One call: what its layers share.
struct CondensedSolver::Run {
  const ContactProblem& problem;
  const Settings& settings;
  const Index bound;  ///< on all iterations
  Solution s;
  bool asked = false;  ///< whether the load can be held
  bool undetermined = false;
  DenseMatrix rigid;  ///< n x k: found where it was asked

  Index left() const { return bound - s.iterations; }
};

CondensedSolver::CondensedSolver(SystemPtr system)
    : system_(std::move(system)), elimination_(std::make_unique<CholmodElimination>()) {}

Solution CondensedSolver::solve(const ContactProblem& problem, const Settings& settings,
                                const Vector& x0) {
  Run run{problem, settings, settings.nbiter > 0 ? settings.nbiter : default_iterations(problem),
          {},      {},       {},
          {}};
  Solution& s = run.s;
  s.route = Route::condensed;
  const Statics statics = balance(elimination_->floating(), problem);
  if (statics.balance == Balance::unheld) {
    s.status = Status::no_equilibrium;
    s.unheld_motion = statics.motion;
  } else {
    refine(run, x0);
  }
  if (s.x.size() == 0) {
    s.x = Vector::Zero(problem.dofs());
    s.certificate = certify(problem, s.x);
  }
  if (s.status != Status::no_equilibrium) rest(run);
  s.state = classify(problem, s.x, s.certificate);
  return std::move(run.s);
}

/// The laws, inside iterative refinement of the equilibrium: the first pass has r = F.
void CondensedSolver::refine(Run& run, const Vector& x0) {
  Solution& s = run.s;
  const ContactProblem& problem = run.problem;
  const Index contact = problem.contact_dofs();
  const Vector D_C = problem.system->weight.tail(contact);
  Vector x = Vector::Zero(problem.dofs()), r = problem.increment.F;
  bool warm = x0.size() > 0;
  Vector x_C = warm ? Vector(x0.tail(contact)) : Vector();
  Vector done_C = Vector::Zero(contact);  // the part of x_C that x already carries
  Real best = std::numeric_limits<Real>::infinity();
  for (int refinement = 0; refinement < refinements; ++refinement) {
    double start = cpu_seconds();
    CondensedProblem condensed{elimination_->S(), elimination_->condense(r), D_C, problem};
    s.times.back_substitution += cpu_seconds() - start;
    start = cpu_seconds();
    if (refinement > 0 && contact > 0) condensed.f.noalias() += elimination_->S() * done_C;
    const Answer a = solve_laws(run, condensed, warm ? &x_C : nullptr);
    s.times.contact += cpu_seconds() - start;

    start = cpu_seconds();
    x += elimination_->recover(a.x_C - done_C);
    s.times.back_substitution += cpu_seconds() - start;
    start = cpu_seconds();
    x_C = done_C = a.x_C;
    warm = true;
    Certificate certificate = certify(problem, x);
    s.times.certificate += cpu_seconds() - start;
    r = certificate.r;
    const Real residual = certificate.residual;
    const bool better = residual < refines * best;
    if (residual < best) {
      best = residual;
      s.x = x;
      s.status = a.status;
      s.certificate = std::move(certificate);
      run.undetermined = a.undetermined;
    }
    if (best <= run.settings.tol || !better || a.status != Status::converged || !x.allFinite())
      break;
  }
  if (best <= run.settings.tol)
    s.status = Status::converged;
  else if (s.status == Status::converged)
    s.status = Status::stagnated;
}

/// Newton's method; where it does not arrive, first whether the load can be held at all.
CondensedSolver::Answer CondensedSolver::solve_laws(Run& run, const CondensedProblem& condensed,
                                                    const Vector* x_C) {
  if (run.problem.nodes() == 0) {
    run.s.layer = Layer::linear;
    return {Vector(0), true};
  }
  if (!run.settings.newton) return by_fixed_point(run, condensed, x_C);
  Answer a = by_newton(run, condensed, x_C);
  if (run.s.layer == Layer::none) run.s.layer = Layer::newton;
  if (a.solved) return a;
  if (unheld(run)) {
    a.status = Status::no_equilibrium;
    return a;
  }
  for (const Layer layer : {Layer::proximal, Layer::continuation}) {
    Attempt attempt = layer == Layer::proximal ? by_proximal_points(condensed, run.left())
                                               : by_growing_friction(condensed, run.left());
    run.s.iterations += attempt.steps;
    if (!attempt.solved) continue;
    run.s.layer = layer;
    last_ = std::move(attempt.branches);
    return {attempt.x, true, attempt.undetermined};
  }
  a = by_fixed_point(run, condensed, x_C);
  if (a.solved) return a;
  if (a.status == Status::regularized || a.status == Status::no_equilibrium)
    a.status = Status::stagnated;
  if (run.left() <= 0) a.status = Status::max_iterations;
  return a;
}

/// Newton from the branches of x_C, or of the last answer; where neither is there, or it fails,
/// from stick.
CondensedSolver::Answer CondensedSolver::by_newton(Run& run, const CondensedProblem& condensed,
                                                   const Vector* x_C) {
  SemismoothNewton newton(condensed);
  const auto attempt = [&] {
    const bool solved =
        newton.solve(std::min(newton_steps, run.left())) == SemismoothNewton::Outcome::converged;
    run.s.iterations += newton.steps();
    if (solved) last_ = newton.branches();
    return solved;
  };
  bool solved = false;
  if (x_C) newton.start_from(*x_C, condensed.residual(*x_C));
  if (!x_C && !last_.empty()) newton.start_from(last_);
  if (x_C || !last_.empty()) solved = attempt();
  if (!solved) {
    newton.start_from_stick();
    solved = attempt();
  }
  Answer a{newton.x(), solved, newton.undetermined()};
  if (!solved) a.status = run.left() > 0 ? Status::stagnated : Status::max_iterations;
  return a;
}

/// The paper's method on S; where it converges, Newton once more.
CondensedSolver::Answer CondensedSolver::by_fixed_point(Run& run, const CondensedProblem& condensed,
                                                        const Vector* x_C) {
  // a body on one or two nodes leaves S without a diagonal to precondition with: then on A itself
  const bool on_S = (condensed.S.diagonal().array() > least_stiffness * condensed.D.array()).all();
  const ContactProblem p = on_S ? on_contact_dofs(condensed) : condensed.laws;
  Settings inner = run.settings;
  inner.method = Method::gc3;
  if (inner.newton) inner.tol = std::max(inner.tol, 1e-6);
  ProjectedCG cg(p, inner, run.left(), nullptr);
  const Solution regularized = FixedPoint(p, inner, cg).solve(x_C && on_S ? *x_C : Vector());
  Solution& s = run.s;
  s.iterations += regularized.iterations;
  s.passes += regularized.passes;
  s.eps = regularized.eps;
  s.steps += regularized.steps;
  s.layer = Layer::fixed_point;
  Answer a{regularized.x.tail(condensed.f.size())};
  a.status = regularized.status;
  a.solved = a.status == Status::converged;
  if (!inner.newton || !a.x_C.allFinite()) return a;
  const Answer newton = by_newton(run, condensed, &a.x_C);
  if (!newton.solved) return a;
  s.eps = 0;
  s.layer = Layer::newton;
  return newton;
}

/// Whether a rigid motion shows that contact and friction cannot hold the load. Asked once a call.
bool CondensedSolver::unheld(Run& run) {
  if (run.asked) return false;
  run.asked = true;
  find_rigid_motions(run);
  const Statics statics = balance(run.rigid, run.problem);
  if (statics.balance != Balance::unheld) return false;
  run.s.unheld_motion = statics.motion;
  return true;
}

/// The kernel of A: what floats, and what S leaves free, as far as A confirms it.
void CondensedSolver::find_rigid_motions(Run& run) {
  if (run.rigid.rows() > 0) return;
  const System& system = *run.problem.system;
  const DenseMatrix W_C = rigid_motions(elimination_->S(), system.D.tail(system.contact_dofs()));
  run.rigid = elimination_->floating();
  for (Index k = 0; k < W_C.cols(); ++k) {
    const Vector w = elimination_->extend(W_C.col(k));
    if (w.dot(system.A * w) > rigid_field * w.dot(system.D.cwiseProduct(w))) continue;
    run.rigid.conservativeResize(system.dofs(), run.rigid.cols() + 1);
    run.rigid.rightCols(1) = w;
  }
}

/// The rigid motions that the branches of the last answer leave free: closed nodes keep x_N, stuck
/// nodes x_T, and sliding nodes the direction of x_T.
DenseMatrix CondensedSolver::left_free(Run& run) {
  find_rigid_motions(run);
  const ContactProblem& problem = run.problem;
  const DenseMatrix W = run.rigid.bottomRows(problem.contact_dofs());
  DenseMatrix forbidden = DenseMatrix::Zero(W.rows(), W.cols());
  for (Index i = 0; i < problem.nodes(); ++i) {
    const SemismoothNewton::Branch& b = last_[i];
    const Index N = problem.system->first[i] - problem.interior(), t = problem.tangents(i);
    const Real unit = std::sqrt(problem.system->D[problem.system->first[i]]);
    if (b.closed) forbidden.row(N) = unit * W.row(N);
    const auto slide = W.middleRows(N + 1, t);
    if (b.stick) forbidden.middleRows(N + 1, t) = unit * slide;
    if (!b.stick && b.g > 0 && t == 2)
      forbidden.row(N + 1) = unit * (b.d[1] * slide.row(0) - b.d[0] * slide.row(1));
  }
  const Eigen::JacobiSVD<DenseMatrix> svd(forbidden, Eigen::ComputeFullV);
  Index held = 0;
  while (held < svd.singularValues().size() && svd.singularValues()[held] > blocked) ++held;
  return run.rigid * svd.matrixV().rightCols(W.cols() - held);
}

/// Takes the least of the rigid motions that nothing determines out of x, where the laws allow it.
void CondensedSolver::rest(Run& run) {
  Solution& s = run.s;
  const Vector& D = run.problem.system->D;
  const bool told = run.undetermined && last_.size() == std::size_t(run.problem.nodes());
  s.undetermined = told ? left_free(run) : elimination_->floating();
  if (s.undetermined.cols() == 0) return;
  const DenseMatrix DV = D.asDiagonal() * s.undetermined;
  const DenseMatrix gram = s.undetermined.transpose() * DV;
  const Vector x = s.x - s.undetermined * gram.ldlt().solve(DV.transpose() * s.x);
  Certificate certificate = certify(run.problem, x);
  if (certificate.residual > std::max(run.settings.tol, s.certificate.residual)) return;
  s.x = x;
  s.certificate = std::move(certificate);
}

}  // namespace frictioncg
