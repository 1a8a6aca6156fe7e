#include "condensed/limits.h"

#include "condensed/interior_point.h"
#include "gradient/fixed_point.h"
#include "model/certificate.h"

namespace frictioncg {

namespace {

/// Newton's method on the full laws is tried after every so many limits.
constexpr Index seldom = 10;
/// Scenes that were solved took 150 to 1500 steps, and flops of dense factors that are half a
/// minute's work.
constexpr Index most_passes = 2000;
constexpr double most_flops = 3e11;

constexpr Real least_stiffness = 1e-8;  ///< of diag(S) over D, to precondition with

/// Problem 2 on S, to rounding.
class TrescaOnS final : public TrescaSolver {
 public:
  TrescaOnS(const CondensedProblem& problem, const ContactProblem& on_contact_dofs, Index max_steps)
      : problem_(problem),
        on_contact_dofs_(on_contact_dofs),
        laws_(problem.laws),
        given_{problem.S, problem.f, problem.D, laws_, 0, problem.observer},
        left_(max_steps) {
    laws_.increment.law = Law::tresca;
  }

  Outcome minimize(Vector& x, const Vector& g, Real, Tangents tangents, Real) override {
    const bool stuck = tangents == Tangents::stuck;
    laws_.increment.g = stuck ? limits_of_stick(on_contact_dofs_) : g;
    Attempt a;
    a.solved = !stuck && newton_from(x, given_, left_, a);
    if (!a.solved) {
      const Index before = a.steps;
      a = by_interior_point(given_, left_ - before);
      a.steps += before;
    }
    if (a.solved && !stuck && ++limits_ % seldom == 0) newton_from(a.x, problem_, left_, a);
    if (a.solved) x = a.x;
    left_ -= a.steps;
    Outcome o;
    o.steps.count[static_cast<int>(StepLabel::newton)] = a.steps;
    if (!a.solved) o.status = left_ > 0 ? Status::stagnated : Status::max_iterations;
    return o;
  }

  bool regularized() const override { return false; }
  /// A pass takes one to three steps: at 15 those give up that move by little for long.
  Index patience() const override { return 60; }

 private:
  const CondensedProblem& problem_;
  const ContactProblem& on_contact_dofs_;
  ContactProblem laws_;
  CondensedProblem given_;
  Index left_, limits_ = 0;
};

/// Iterations on S: their x is that of no caller.
class OnContactDofs final : public Observer {
 public:
  OnContactDofs(const ContactProblem& problem, Observer* caller)
      : problem_(problem), caller_(caller) {}
  void iterate(Index, StepLabel, const Vector& x) override {
    if (caller_)
      caller_->step(Work::gradient, caller_->listens() ? certify(problem_, x).residual : 0);
  }

 private:
  const ContactProblem& problem_;
  Observer* const caller_;
};

}  // namespace

Attempt by_limits(const CondensedProblem& problem, const Settings& settings) {
  Attempt a;
  if (problem.laws.increment.law != Law::coulomb || settings.nbiter <= 0) return a;
  const auto affordable = static_cast<Index>(
      std::min<double>(most_flops / std::pow(double(problem.f.size()), 3), most_passes));
  const ContactProblem p = problem.on_contact_dofs();
  TrescaOnS tresca(problem, p, std::min(settings.nbiter, affordable));
  const Solution s = fixed_point(p, settings, tresca, Vector());
  a.steps = s.iterations;
  a.x = s.x;
  a.solved = s.status == Status::converged;
  return a;
}

Solution by_regularization(const CondensedProblem& problem, const Settings& settings,
                           const Vector& start) {
  Settings gc3 = settings;
  gc3.method = Method::gc3;
  // a body on one or two nodes leaves S without a diagonal to precondition with: then on A itself
  const bool on_S = (problem.S.diagonal().array() > least_stiffness * problem.D.array()).all();
  const ContactProblem p = on_S ? problem.on_contact_dofs() : problem.laws;
  OnContactDofs observer(p, problem.observer);
  const auto cg = make_tresca_solver(p, gc3, &observer);
  Solution s = fixed_point(p, gc3, *cg, on_S ? start : Vector());
  s.x = Vector(s.x.tail(problem.f.size()));
  return s;
}

}  // namespace frictioncg
