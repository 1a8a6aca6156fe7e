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
                })->get();
  if (!domain && site.is_on_part(stack))
    throw IllegalInput(
        "domain is a contactdomain that is not set, but the mesh is one process's part of a "
        "distributed one; let createMat(Th, C, Pk) set it");
  return domain;
}

/// Reads the problem of all processes: geometry, laws, the matrix.   Collective.
inline std::shared_ptr<SharedScene> read_shared(Stack stack, const Arguments& args,
                                                const Expression A, const Site& site,
                                                std::shared_ptr<const Domain> domain,
                                                bool everywhere, const Opening& opening,
                                                PointLaws& laws) {
  const Timed timed(Phase::pose);
  auto shared = std::make_shared<SharedScene>();
  shared->domain = std::move(domain);
  shared->number = shared->domain->meeting().next_number();
  Stage stage;
  shared->domain->agree([&] { stage = read_stage(stack, args); });
  shared->scene = part_of(site, stack, opening, *shared->domain, stage);
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
  const Real counts[] = {Real(scene.nodes.size()), Real(scene.averted.size())};
  if (shared->domain->largest(counts[0]) == 0 && shared->domain->largest(counts[1]) > 0)
    shared->domain->agree([&] {
      if (!scene.averted.empty()) refuse_inward(scene);
    });
  agree_on_tangents(*shared, laws);
  share(matrix, *shared);
  return shared;
}

}  // namespace frictioncg
