#include "condensed/regularized.h"

#include "gradient/fixed_point.h"
#include "model/certificate.h"

namespace frictioncg {

namespace {

constexpr Real least_stiffness = 1e-8;  ///< of diag(S) over D, to precondition with

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
