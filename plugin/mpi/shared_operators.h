#pragma once
#include "../freefem/freefem.h"

#include "shared_pair.h"
#include "shared_site.h"

namespace frictioncg {

/// The domain of a call of this operator; null on a process that solves alone. Without domain=
/// every process would take its own matrix for the whole problem.
inline std::shared_ptr<const Domain> domain_of(Stack stack, const Arguments& args,
                                               const Site& site) {
  if (mpisize > 1 && !args.has(p_domain))  // 0 in FreeFem++ itself
    refuse("there are ", mpisize,
           " processes, and each would take its own matrix for the whole problem; give domain=C, "
           "which createMat(Th, C, Pk) makes, or, for a problem of its own on each process, a "
           "contactdomain that is not set");
  if (!args.has(p_domain)) return nullptr;
  auto domain = evaluated(name_of(p_domain), [&] {
                  return GetAny<ContactDomainVariable*>((*args.expression(p_domain))(stack));
                })->value;
  if (!domain && site.is_on_part(stack))
    throw IllegalInput(
        "domain is a contactdomain that is not set, but the mesh is one process's part of a "
        "distributed one; let createMat(Th, C, Pk) set it");
  return domain;
}

/// Reads the problem of all processes: geometry, laws, the matrix.   Collective.
inline std::shared_ptr<SharedScene> read_shared(Stack stack, const Arguments& args,
                                                const Expression A, const Site& site,
                                                bool everywhere, const Opening& opening,
                                                PointLaws& laws) {
  const Timed timed(Phase::pose);
  auto shared = std::make_shared<SharedScene>();
  shared->domain = opening.domain;
  shared->number = shared->domain->meeting().next_number();
  Stage stage;
  shared->domain->agree([&] { stage = read_stage(stack, args); });
  shared->scene = part_of(site, stack, opening, stage);
  shared->extent = extents_of_all(*shared->domain, {shared->scene->places()}).front();
  if (site.two_bodies()) {
    read_pair(stack, args, A, everywhere, opening, *shared, laws);
    return shared;
  }
  Scene& scene = *shared->scene;
  Triplets matrix;
  shared->domain->agree([&] {
    set_weights(stack, args, scene);
    set_normals(stack, args, scene);
    laws = read_point_laws(stack, args, everywhere, scene, opening.laws);
    matrix = matrix_of(stack, A, scene.dofs);
  });
  if (shared->domain->largest(Real(scene.nodes.size())) == 0)
    shared->domain->agree([&] {
      if (!scene.averted.empty()) refuse_inward(scene);
    });
  agree_on_tangents(*shared, laws);
  share(matrix, *shared);
  return shared;
}

/// Laws at the contact points of own nodes, with those of ghosts, which follow: their gaps, as
/// their owners have them; friction is the owner's matter.   Collective.
inline PointLaws with_ghosts(PointLaws laws, const SharedScene& shared) {
  constexpr Index most = 3;  // points of a node
  const std::vector<BoundaryNode>& nodes = shared.scene->nodes;
  const Index all = static_cast<Index>(nodes.size());
  Eigen::MatrixXd gap = Eigen::MatrixXd::Zero(most, shared.domain->dofs());
  const auto for_each_point = [&](const auto& visit) {
    std::vector<Index> seen(shared.domain->dofs(), 0);
    for (Index k = 0; k < all; ++k) {
      const Index dof = nodes[k].point.dof[0];
      visit(laws.gap[k], gap(seen[dof]++, dof));
    }
  };
  laws.gap.conservativeResize(all);
  for_each_point([](Real of_law, Real& sent) { sent = of_law; });
  shared.domain->update(gap);
  for_each_point([](Real& of_law, Real received) { of_law = received; });
  if (laws.law == Law::frictionless) return laws;
  for (Vector* values :
       {laws.law == Law::coulomb ? &laws.mu : &laws.g, &laws.cohesion, &laws.cap}) {
    if (values->size() == 0 && shared.own_points > 0) continue;  // not given
    values->conservativeResize(all);
    values->tail(all - static_cast<Index>(shared.own_points)).setZero();
  }
  return laws;
}

/// The call, apart from what is given by name.
inline std::string form_of(const char* name, const Site& site) {
  return std::string(name) + (site.two_bodies() ? " of two bodies in " : " in ") +
         std::to_string(site.d) + "D";
}

/// Begins a call on a space: its domain, or null, its labels, and what its laws are.
inline void open_on_site(Opening& opening, Stack stack, const Arguments& args, const Site& site) {
  opening.alone([&] {
    opening.domain = domain_of(stack, args, site);
    if (!opening.domain) return;
    refuse_obstacles(args);
    opening.labels = site.labels(stack);
    opening.masters = site.masters(stack);
    opening.facing.maxgap = args.value(stack, p_maxgap, opening.facing.maxgap);
    opening.facing.smooth = args.value(stack, p_smooth, opening.facing.smooth);
    opening.laws = begun_laws(stack, args);
  });
}

/// u[] = frictionalContactCG(A, b, Vh, labels, ..., domain=C).
class SharedSolveOnce : public SolveOnce {
 public:
  using SolveOnce::SolveOnce;
  AnyType operator()(Stack stack) const override {
    Opening opening(operator_name, form_of(operator_name, site_), arguments_);
    open_on_site(opening, stack, arguments_, site_);
    if (opening.is_alone()) return solved_alone([&] { return SolveOnce::operator()(stack); });
    opening.alone([&] { opening.call = read_call(stack, arguments_, b_, site_.two_bodies()); });
    return opening.with_others([&] {
      PointLaws laws;
      const auto shared = read_shared(stack, arguments_, A_, site_, false, opening, laws);
      return result(stack,
                    solve_together(stack, *opening.call, *shared, with_ghosts(laws, *shared)));
    });
  }
};

/// contactproblem P = contactProblem(A, Vh, labels, ..., domain=C).
class SharedConstruct : public Construct {
 public:
  using Construct::Construct;
  AnyType operator()(Stack stack) const override {
    Opening opening(constructor_name, form_of(constructor_name, site_), arguments_);
    open_on_site(opening, stack, arguments_, site_);
    if (opening.is_alone()) return solved_alone([&] { return Construct::operator()(stack); });
    return opening.with_others([&] {
      PosedProblem posed;
      posed.shared = read_shared(stack, arguments_, A_, site_, true, opening, posed.laws);
      posed.scene = posed.shared->scene;
      posed.laws = with_ghosts(posed.laws, *posed.shared);
      return variable(stack, std::move(posed));
    });
  }
};

/// u[] = frictionalContactCG(P, b, ...), on a contactproblem of one process or of all.
class SharedSolveIncrement : public SolveIncrement {
 public:
  using SolveIncrement::SolveIncrement;
  AnyType operator()(Stack stack) const override {
    PosedProblem posed;
    Opening opening(operator_name, std::string(operator_name) + " of a contactproblem", arguments_);
    opening.alone([&] {
      posed = posed_by(evaluated("the contactproblem",
                                 [&] { return GetAny<ContactProblemVariable*>((*C_)(stack)); }));
      if (posed.shared) opening.domain = posed.shared->domain;
    });
    if (opening.is_alone()) return solved_alone([&] { return SolveIncrement::operator()(stack); });
    opening.alone([&] {
      opening.problem = posed.shared->number;
      refuse_obstacles(arguments_);
      refuse_friction_of_none("P", arguments_, *posed.scene);
      opening.call = read_call(stack, arguments_, b_, posed.shared->interface != nullptr);
      opening.laws = begun_laws(stack, arguments_, posed.laws);
    });
    return opening.with_others([&] {
      SharedScene& shared = *posed.shared;
      PointLaws laws = opening.laws;
      if (shared.interface && arguments_.has(p_gap))
        laws.gap = gap_of_all(stack, arguments_, shared);
      laws = read_increment_laws(stack, shared, laws);
      return result(stack, solve_together(stack, *opening.call, shared, with_ghosts(laws, shared)));
    });
  }

 private:
  /// Expressions of the call at the own points alone: ghosts have no place.   Collective.
  PointLaws read_increment_laws(Stack stack, const SharedScene& shared, PointLaws laws) const {
    std::vector<BoundaryNode>& nodes = shared.scene->nodes;
    const std::vector<BoundaryNode> all = nodes;
    nodes.resize(shared.own_points);
    if (laws.gap.size() > 0) laws.gap.conservativeResize(static_cast<Index>(shared.own_points));
    const Attempt own_part =
        attempt([&] { laws = read_laws(stack, arguments_, *shared.scene, laws); });
    nodes = all;
    shared.domain->agree(own_part);
    return laws;
  }
};

}  // namespace frictioncg
