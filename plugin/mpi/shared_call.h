#pragma once
#include "../freefem/freefem.h"

#include "../core/answer.h"
#include "../core/statics/undetermined.h"
#include "../freefem/outputs.h"
#include "shared_pair.h"
#include "shared_report.h"

namespace frictioncg {

/// As Solver::solve has it, by multigrid; where that does not arrive, and the whole is not too
/// large, by its factorization in place of the cycle, for this call and those that follow.
/// Collective.
inline Solution solve_together(SharedScene& shared, const ContactProblem& problem,
                               const Settings& settings, const Vector& x0, Observer* observer) {
  // Over the usual cost of multigrid: a factorization takes less. Of the bodies of
  // tests/bench/routes.edp that hang over a gap those arrive by the cycle of one process whose
  // first forces violate the laws by less than 9e4 times the load, and those above 1e5 do not.
  constexpr Allowance patience{10, 1e5};
  const auto by_layers = [&] {
    const bool last = shared.coarsening == Coarsening::none || !may_be_factorized(*shared.A);
    const Allowance allowance = last ? Allowance() : patience;
    const Solution s = shared.solver->solve(problem, settings, x0, observer, allowance);
    const Settings rest = what_remains(problem, settings, s);
    if (last || decided(s) || rest.nbiter <= 0) return s;
    set_solver(shared, Coarsening::none);
    return after(s, shared.solver->solve(problem, rest, x0, observer));
  };
  const Timed timed(Phase::solve);
  return answer(
      problem, settings, [&] { return shared.solver->floating(); }, by_layers);
}

/// A solution over the own dofs as one over the local ones, ghosts by their owners.   Collective.
inline Solution on_local_dofs(const SharedScene& shared, const Solution& own) {
  const System &local = *shared.scene->system->system(), &system = *shared.A;
  Solution s = own;
  s.x = shared.A->on_local(own.x);
  s.certificate.r = shared.A->on_local(own.certificate.r);
  Vector state = Vector::Zero(system.dofs());  // of each node, at its normal
  for (Index k = 0; k < system.nodes(); ++k) state[system.first[k]] = Real(own.state[k]);
  state = shared.A->on_local(state);
  s.state.clear();
  for (Index k = 0; k < local.nodes(); ++k)
    s.state.push_back(static_cast<NodeState>(static_cast<int>(state[local.first[k]])));
  return s;
}

/// Values at ghosts from their owners, for the dofs of the script alone: all processes ask for the
/// same vectors. Null: not asked for.   Collective.
template <class Number>
void update(const SharedScene& shared, KN<Number>* values) {
  if (!values) return;
  Vector all(values->N());
  for (Index i = 0; i < all.size(); ++i) all[i] = static_cast<Real>((*values)[i]);
  shared.domain->update(all);
  values->resize(shared.script.count);
  for (long i = 0; i < values->N(); ++i) (*values)[i] = static_cast<Number>(all[i]);
}

/// A vector of the script with the values of guests. Between two bodies all that is shared is its
/// owner's word: forces on the slave are summed up at masters elsewhere.   Collective.
inline Vector with_guests(const SharedScene& shared, const Vector& of_script) {
  if (!shared.interface) return of_script;
  Vector all = Vector::Zero(shared.scene->ndof());
  all.head(of_script.size()) = of_script;
  shared.domain->update(all);
  return all;
}

/// The load of a call, of A less the stiffness of forceold where the matrix is that.   Collective.
inline Vector load_of(const Call& call, const SharedScene& shared) {
  Vector b = with_guests(shared, call.b);
  if (!shared.stiffened) return b;
  shared.stiffened->multiply_addend(with_guests(shared, *shared.scene->at), b);
  shared.domain->update(b);
  return b;
}

/// Where friction counts slips from, in local dofs; empty where the call does not say. Ghosts by
/// their owners: the rows of W are whole for own dofs alone.   Collective.
inline Vector slip_from(const Call& call, const SharedScene& shared) {
  if (!call.args.has(p_uold)) return {};
  const Vector local = shared.scene->slip_from(with_guests(shared, call.u_old));
  return shared.A->on_local(shared.A->own_part(local));
}

/// Poses the increment under a load (patched), over the own dofs and nodes; returns that of the
/// local system.   Collective.
inline LocalIncrement pose(const SharedScene& shared, const Vector& b, const Vector& w_old,
                           const PointLaws& laws, ContactProblem& problem) {
  LocalIncrement local;
  LocalLoad load;
  shared.domain->agree([&] {
    load = shared.scene->system->load_from(b, w_old, shared.scene->at != nullptr);
    local = shared.scene->increment(load, laws);
  });
  Increment& own = problem.increment = local.increment;
  for (Vector* v : {&own.gap, &own.mu, &own.g, &own.cohesion, &own.cap})
    if (v->size() > 0) *v = Vector((*v)(shared.numbering().own_nodes));
  for (Vector* v : {&load.external, &load.total, &load.F, &load.sizes}) *v = shared.A->own_part(*v);
  set_load(load, *shared.A, own);
  if (laws.law != Law::frictionless) return local;
  const Real told =
      told_by_mesh(*shared.scene, shared.mortar ? shared.mortar->told() : 0, *shared.A);
  if (told > 0)
    local.left_out = leave_out_uncertain_work(*shared.A, shared.solver->floating(), told, own.F);
  return local;
}

/// The vectors of a call, consistent between the processes, as an increment.   Collective.
inline LocalIncrement increment_together(const Call& call, const SharedScene& shared,
                                         const PointLaws& laws, ContactProblem& problem,
                                         long verb) {
  const Domain& domain = *shared.domain;
  domain.agree([&] { check_vectors(call, shared.script); });
  const Vector b = shared.patch->load(domain, load_of(call, shared));
  LocalIncrement local = pose(shared, b, slip_from(call, shared), laws, problem);
  report_leftover(
      check_data(*shared.scene, b, local.u0, *shared.A, 2 * shared.extent.radius, domain), verb);
  report_left_out(local.left_out, verb);
  domain.agree([&] { validate(problem.increment, *problem.system); });
  return local;
}

/// As in one process: from the answer s of the problem, whose increment starts at u0.   Collective.
inline Solution newton_step(Solution s, const Vector& u0, const Call& call, SharedScene& shared,
                            const PointLaws& laws, ContactProblem problem) {
  const Domain& domain = *shared.domain;
  if (domain.largest(problem.nodes()) == 0) return s;
  const WholeInterface& faces = *shared.interface;
  const Vector b = load_of(call, shared), w_old = slip_from(call, shared);
  const auto trace = [&](const Solution& of) {
    return faces.at_nodes(domain, shared.scene->system->to_global(shared.A->on_local(of.x), u0));
  };
  const auto pass = [&](const AtNodes& v, const Vector& x0) {
    const mortar::Change change =
        mortar::change(*shared.mortar, v, mortar::straightened(faces.d, faces.pairs, v));
    PointLaws of_pass = laws;
    if (!laws.given_gap)
      of_pass.gap.head(Index(shared.in_mortar.size())) += change.gap(shared.in_mortar);
    Vector of_dofs = faces.on_free_dofs(v, b.size());
    domain.update(of_dofs);
    Vector rest = b + faces.on_free_dofs(change.force, b.size());
    shared.stiffened->multiply_addend(of_dofs, rest);
    domain.update(rest);
    pose(shared, shared.patch->load(domain, rest), w_old, of_pass, problem);
    return solve_together(shared, problem, call.settings, x0, nullptr);
  };
  return newton_step(std::move(s), faces.at_nodes(domain, *shared.scene->at), trace, pass);
}

/// The field of one increment.   Collective.
inline Vector solve_together(Stack stack, const Call& call, SharedScene& shared, PointLaws laws) {
  const Domain& domain = *shared.domain;
  const Outputs out{stack, call.args};
  ContactProblem problem{shared.A, {}};
  if (domain.largest(problem.nodes()) == 0) laws.law = Law::frictionless;
  const long verb = domain.rank() == 0 ? call.verb : 0;
  LocalIncrement now = increment_together(call, shared, laws, problem, verb);
  const bool speaks = domain.largest(static_cast<Real>(verb)) > 0;
  if (speaks) report_plan(shared, problem, verb);
  Progress progress(problem, verb, out.history);
  const auto answer = [&](const Settings& settings) {
    Vector x0;
    if (call.args.has(call.args.start())) {
      x0 = call.u_old.size() == 0 ? call.u_init : Vector(call.u_init - call.u_old);
      x0 = shared.A->own_part(shared.scene->system->to_local(with_guests(shared, x0)));
    }
    Solution s =
        solve_together(shared, problem, settings, x0, out.history || speaks ? &progress : nullptr);
    if (s.status == Status::stagnated &&
        passes_by_rounding(s, domain.largest(contrast(*shared.scene->system->system())), call.args,
                           shared.scene->at != nullptr))
      s.status = Status::converged;
    return s;
  };
  Solution solution = answer(call.settings);
  const Settings rest = what_remains(problem, call.settings, solution);
  if (solution.status != Status::converged && shared.stiffened && rest.nbiter > 0) {
    assemble_plain(shared, verb);
    problem.system = shared.A;
    now = increment_together(call, shared, laws, problem, 0);
    solution = after(solution, answer(rest));
  }
  if (shared.stiffened && solution.status == Status::converged)
    solution = newton_step(std::move(solution), now.u0, call, shared, laws, problem);
  Solution local = on_local_dofs(shared, solution);
  const Vector field = shared.scene->system->to_global(local.x, now.u0);
  Vector from_geometry = field;
  if (shared.scene->at) from_geometry -= with_guests(shared, *shared.scene->at);
  const std::string turned = runaway(shared, problem, solution, from_geometry);
  if (!turned.empty()) solution.status = local.status = Status::runaway;
  const std::string blamed = turned.empty() ? blamed_motion(shared, solution) : turned;
  if (verb > 0) report_end(solution, blamed);
  report_undetermined(shared, solution, verb);
  if (solution.status != Status::converged && !out.status)
    refuse_unconverged(solution, call.settings, blamed);
  write_outputs(*shared.scene, local, laws, progress, out);  // of ghosts as their owners have them
  update(shared, out.force);
  update(shared, out.state);
  update(shared, out.normals);
  update(shared, out.distance);
  if (speaks) warn_of_large_displacements(shared, field, verb);
  return shared.domain->of_owners(field).head(shared.script.count);
}

}  // namespace frictioncg
