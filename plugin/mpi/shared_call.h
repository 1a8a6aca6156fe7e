#pragma once
#include "../freefem/freefem.h"

#include "../core/answer.h"
#include "shared_report.h"

namespace frictioncg {

/// As Solver::solve has it, by multigrid alone.
inline Solution solve_together(SharedScene& shared, const ContactProblem& problem, const Call& call,
                               const Vector& x0, Observer* observer) {
  const Timed timed(Phase::solve);
  return answer(
      problem, call.settings, [&] { return shared.solver->floating(); },
      [&] { return shared.solver->solve(problem, call.settings, x0, observer); });
}

/// A solution over the own dofs as one over the local ones; ghosts are 0.
inline Solution on_local_dofs(const SharedScene& shared, const Solution& own) {
  const Numbering& numbering = shared.numbering();
  const System& local = *shared.scene->system->system();
  Solution s = own;
  s.x = s.certificate.r = Vector::Zero(local.dofs());
  for (std::size_t k = 0; k < numbering.own.size(); ++k) {
    s.x[numbering.own[k]] = own.x[static_cast<Index>(k)];
    s.certificate.r[numbering.own[k]] = own.certificate.r[static_cast<Index>(k)];
  }
  s.state.assign(local.nodes(), NodeState::none);
  for (std::size_t k = 0; k < numbering.own_nodes.size(); ++k)
    s.state[numbering.own_nodes[k]] = own.state[k];
  return s;
}

/// Values at ghosts from their owners, where the call has the vector: all processes ask for the
/// same.
template <class Number>
void update(const Domain& domain, KN<Number>* values) {
  if (!values) return;
  KN<Number>& v = *values;
  domain.update(
      1, [&](Index dof, Real* out) { *out = static_cast<Real>(v[dof]); },
      [&](Index dof, const Real* in) { v[dof] = static_cast<Number>(*in); });
}

/// The outputs of a call: of own dofs as in one process, of ghosts as their owners have them.
inline void write_together(const SharedScene& shared, const Solution& local,
                           const Progress& progress, const Outputs& out) {
  write_outputs(*shared.scene, local, progress, out);
  update(*shared.domain, out.force);
  update(*shared.domain, out.state);
  update(*shared.domain, out.normals);
}

/// The vectors of a call, consistent between the processes, as an increment.   Collective.
inline LocalIncrement increment_together(const Call& call, const SharedScene& shared,
                                         const PointLaws& laws, ContactProblem& problem) {
  const Domain& domain = *shared.domain;
  const Scene& scene = *shared.scene;
  domain.agree([&] { check_vectors(call, scene); });
  const Vector b = shared.patch->load(domain, call.b);
  Vector u_old = call.u_old;
  if (call.args.has(p_uold)) domain.update(u_old);
  LocalIncrement local;
  LocalLoad load;
  domain.agree([&] {
    load = scene.system->load(b, u_old);
    local = scene.increment(load, laws);
  });
  report_leftover(check_data(shared, b, local.u0), domain.rank() == 0 ? call.verb : 0);
  problem.increment = own_increment(shared, local, load);
  domain.agree([&] { validate(problem.increment, *problem.system); });
  return local;
}

/// Where the iteration starts (own dofs): empty where the call does not say.
inline Vector start_of(const Call& call, const SharedScene& shared) {
  if (!call.args.has(call.args.start())) return {};
  const Vector start = call.u_old.size() == 0 ? call.u_init : Vector(call.u_init - call.u_old);
  return shared.A->own_part(shared.scene->system->to_local(start));
}

/// The field of one increment.   Collective.
inline KN_<double> solve_together(Stack stack, const Call& call, SharedScene& shared,
                                  PointLaws laws) {
  const Domain& domain = *shared.domain;
  const Outputs out(stack, call.args);
  ContactProblem problem{shared.system, {}};
  if (domain.largest(problem.nodes()) == 0) laws.law = Law::frictionless;
  const LocalIncrement now = increment_together(call, shared, laws, problem);
  const long verb = domain.rank() == 0 ? call.verb : 0;
  const bool speaks = domain.largest(static_cast<Real>(verb)) > 0;
  if (speaks) report_plan(shared, problem, verb);
  Progress progress(problem, verb, out.history);
  const Traffic before = traffic_so_far(domain);
  Solution solution = solve_together(shared, problem, call, start_of(call, shared),
                                     out.history || speaks ? &progress : nullptr);
  const Traffic traffic = traffic_so_far(domain) - before;
  Solution local = on_local_dofs(shared, solution);
  const Vector field = shared.scene->system->to_global(local.x, now.u0);
  const std::string turned = runaway(shared, solution, field);
  if (!turned.empty()) solution.status = local.status = Status::runaway;
  if (verb > 0) report_end(solution);
  report_traffic(domain, traffic, solution.iterations, verb);
  std::string unheld = report_motions(shared, solution, verb);
  if (!turned.empty()) unheld = turned;
  if (verb > 0 && !turned.empty()) line() << turned << std::endl;
  if (solution.status != Status::converged && !out.status)
    refuse_unconverged(solution, call.settings, unheld);
  write_together(shared, local, progress, out);
  const long n = shared.scene->ndof();
  KN<double>* u = Add2StackOfPtr2Free(stack, new KN<double>(n));
  if (speaks) warn_of_large_displacements(shared, field, verb);
  for (long i = 0; i < n; ++i) (*u)[i] = field[i];
  update(domain, u);
  return *u;
}

}  // namespace frictioncg
