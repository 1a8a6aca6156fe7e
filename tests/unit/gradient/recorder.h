#pragma once
// What a minimization at a given sliding limit does, iteration by iteration.
#include "../scene.h"
#include "core/gradient/regularization.h"
#include "core/gradient/tresca.h"
#include "core/solver.h"

namespace frictioncg::test {

/// J of (5), or J_eps of (11) with eps > 0.
inline Real energy(const ContactProblem& p, const Vector& g, const Phi& phi, const Vector& x) {
  Real sum = x.dot(0.5 * (p.system->entries() * x) - p.increment.F);
  for (Index i = 0; i < p.nodes(); ++i)
    if (g[i] > 0 && p.tangents(i) > 0) sum += g[i] * phi.value(tangential_norm(*p.system, i, x));
  return sum;
}

/// Norm (norm_D) of -J' over the interior, the open normals and the tangents that slide.
inline Real open_residual(const ContactProblem& p, const Vector& g, const Phi& phi,
                          const Vector& x) {
  Vector r = p.increment.F - p.system->entries() * x;
  for (Index i = 0; i < p.nodes(); ++i) {
    const Index N = p.system->first[i], t = p.tangents(i);
    if (x[N] >= p.increment.gap[i]) r[N] = 0;
    const Real slip = tangential_norm(*p.system, i, x);
    if (slip == 0 && phi.eps == 0)
      r.segment(N + 1, t).setZero();
    else if (g[i] > 0)
      r.segment(N + 1, t) -= g[i] * phi.slope_over_t(slip) * x.segment(N + 1, t);
  }
  return norm_D(*p.system, r);
}

struct Recorded {
  StepLabel label;
  Vector x;
};

/// Keeps the label and the field of each iteration.
class Recorder final : public Observer {
 public:
  void iterate(Index iteration, StepLabel label, const Vector& x) override {
    if (iteration != static_cast<Index>(steps.size()) + 1)
      throw std::logic_error("iterations are not numbered one by one");
    steps.push_back({label, x});
  }
  std::vector<Recorded> steps;
};

/// One minimization by the method of the settings.
struct Minimized {
  Outcome outcome;
  Vector x;
  Phi phi;
  std::vector<Recorded> steps;
};

inline Minimized minimize(const ContactProblem& p, Settings settings, const Vector& g,
                          const Vector& x0, Real eps, Real bound,
                          Tangents tangents = Tangents::sliding) {
  Recorder recorder;
  Minimized m;
  settings.nbiter = 20000;
  const auto solver = make_tresca_solver(p, settings, &recorder);
  m.phi = solver->regularized() ? Phi{settings.reg, eps} : Phi{Regularization::polynomial, 0};
  m.x = x0;
  m.outcome = solver->minimize(m.x, g, eps, tangents, bound);
  m.steps = std::move(recorder.steps);
  return m;
}

}  // namespace frictioncg::test
