#include "condensed/condensed.h"

#include <cmath>
#include <limits>

#include "clock.h"
#include "condensed/equilibrium.h"
#include "gradient/fixed_point.h"
#include "gradient/projected_cg.h"

namespace frictioncg {

namespace {

constexpr Index newton_steps = 40;
constexpr Real least_stiffness = 1e-8;  ///< of diag(S) over diag(A)

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

/// Newton on the laws, inside iterative refinement of the equilibrium: the first pass has r = F. A
/// load that cannot be held is told by a rigid motion, before anything else is tried.
Solution CondensedSolver::solve(const ContactProblem& problem, const Settings& settings,
                                const Vector& x0) {
  Solution s;
  s.route = Route::condensed;
  const Index contact = problem.contact_dofs();
  const Vector D_C = problem.system->D.tail(contact);
  Vector x = Vector::Zero(problem.dofs()), r = problem.increment.F;
  bool warm = x0.size() > 0;
  Vector x_C = warm ? Vector(x0.tail(contact)) : Vector(Vector::Zero(contact));
  Vector done_C = Vector::Zero(contact);  // the part of x_C that x already carries
  Real best = std::numeric_limits<Real>::infinity();
  for (int refinement = 0; refinement < 4; ++refinement) {
    double start = cpu_seconds();
    CondensedProblem condensed{condensation_.S(), condensation_.reduce(r), D_C, problem};
    s.times.back_substitution += cpu_seconds() - start;
    start = cpu_seconds();
    if (refinement > 0 && contact > 0) condensed.f.noalias() += condensation_.S() * done_C;
    Attempt a;
    a.x = x_C;
    a.solved = problem.nodes() == 0;  // a plain linear solve
    if (!a.solved && settings.polish) a = polish(condensed, warm ? &x_C : nullptr, s);
    if (!a.solved && cannot_be_held(condensed)) {
      a.status = Status::no_equilibrium;
    } else {
      if (!a.solved && settings.polish) a = by_continuation(condensed, s);
      if (!a.solved) a = by_fixed_point(condensed, settings, x_C, s);
      if (!a.solved && settings.polish && a.status == Status::regularized)
        a.status = Status::fixed_point_diverged;
    }
    s.times.contact += cpu_seconds() - start;

    start = cpu_seconds();
    x += condensation_.expand(a.x - done_C);
    s.times.back_substitution += cpu_seconds() - start;
    start = cpu_seconds();
    x_C = done_C = a.x;
    warm = true;
    Certificate certificate = certify(problem, x);
    s.times.certificate += cpu_seconds() - start;
    if (certificate.residual < best) {
      s.x = x;
      s.status = a.status;
      s.certificate = certificate;
    }
    const bool better = certificate.residual < 0.3 * best;
    best = std::min(best, certificate.residual);
    r = certificate.r;
    if (best <= settings.tol || !better || a.status != Status::converged || !x.allFinite()) break;
  }
  if (best <= settings.tol)
    s.status = Status::converged;
  else if (s.status == Status::converged)
    s.status = Status::stagnated;
  if (s.x.size() == 0) {
    s.x = Vector::Zero(problem.dofs());
    s.certificate = certify(problem, s.x);
  }
  s.state = classify(problem, s.x, s.certificate);
  return s;
}

/// Newton from the branches of x_C, or of the last answer; where neither is there, or it fails,
/// from stick.
CondensedSolver::Attempt CondensedSolver::polish(const CondensedProblem& condensed,
                                                 const Vector* x_C, Solution& s) {
  SemismoothNewton newton(condensed);
  const auto attempt = [&] {
    const bool solved = newton.solve(newton_steps) == SemismoothNewton::Outcome::converged;
    s.iterations += newton.steps();
    if (solved) last_ = newton.branches();
    return solved;
  };
  bool solved = false;
  if (x_C) newton.start_from(*x_C, condensed.f - condensed.S * *x_C);
  if (!x_C && !last_.empty()) newton.start_from(last_);
  if (x_C || !last_.empty()) solved = attempt();
  if (!solved) {
    newton.start_from_stick();
    solved = attempt();
  }
  return {newton.x(), solved, Status::converged};
}

/// mu from 0 up to its value, each solution the start of the next; the step adapts.
CondensedSolver::Attempt CondensedSolver::by_continuation(const CondensedProblem& condensed,
                                                          Solution& s) {
  Attempt last;
  ContactProblem laws = condensed.laws;
  if (laws.increment.law != Law::coulomb) return last;
  const CondensedProblem scaled{condensed.S, condensed.f, condensed.D, laws};
  Real reached = 0, step = 0.25;
  Vector x;
  while (reached < 1 && step > 1.0 / 512) {
    const Real next = std::min(1.0, reached + step);
    laws.increment.mu = next * condensed.laws.increment.mu;
    SemismoothNewton newton(scaled);
    if (x.size() > 0)
      newton.start_from(x, scaled.f - scaled.S * x);
    else
      newton.start_from_stick();
    const auto outcome = newton.solve(newton_steps);
    s.iterations += newton.steps();
    if (outcome == SemismoothNewton::Outcome::converged) {
      x = newton.x();
      reached = next;
      step *= 2;
    } else {
      step /= 2;
    }
  }
  last.x = x;
  last.solved = reached == 1;
  return last;
}

/// The paper's method on S; where it converges, one more polish.
CondensedSolver::Attempt CondensedSolver::by_fixed_point(const CondensedProblem& condensed,
                                                         const Settings& settings,
                                                         const Vector& x_C, Solution& s) {
  // a body on one or two nodes leaves S without a diagonal to precondition with: then on A itself
  const bool on_S = (condensed.S.diagonal().array() > least_stiffness * condensed.D.array()).all();
  const ContactProblem p = on_S ? on_contact_dofs(condensed) : condensed.laws;
  Settings inner = settings;
  inner.method = Method::gc3;
  if (settings.polish) inner.tol = std::max(settings.tol, 1e-6);
  const Index bound = settings.nbiter > 0 ? settings.nbiter : default_iterations(p);
  ProjectedCG cg(p, inner, bound, nullptr);
  const Vector start = x_C.isZero(0) || !on_S ? Vector() : x_C;
  const Solution regularized = FixedPoint(p, inner, cg).solve(start);
  s.iterations += regularized.iterations;
  s.passes += regularized.passes;
  s.eps = regularized.eps;
  Attempt a{regularized.x.tail(x_C.size()), regularized.status == Status::converged,
            regularized.status};
  if (!settings.polish || !a.x.allFinite()) return a;
  Attempt polished = polish(condensed, &a.x, s);
  if (polished.solved) {
    s.eps = 0;
    return polished;
  }
  return a;
}

}  // namespace frictioncg
