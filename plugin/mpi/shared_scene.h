#pragma once
#include "../freefem/freefem.h"

#include "../freefem/call.h"
#include "../freefem/checks.h"
#include "../freefem/node_values.h"
#include "ghosts.h"
#include "guests.h"
#include "hierarchy.h"
#include "model/inertia.h"
#include "multigrid/multigrid_solver.h"
#include "whole_interface.h"

namespace frictioncg {

/// The bodies of all processes: the overlapping part of this one, as the script has it, and the
/// system that it owns of the whole.
struct SharedScene {
  std::shared_ptr<const Domain> domain;   ///< with the guests of two bodies
  int number = 0;                         ///< as that of a domain
  std::shared_ptr<Scene> scene;           ///< overlapping; contact points of ghosts included
  std::size_t own_points = 0;             ///< of the contact points; those of ghosts follow
  std::unique_ptr<PatchedMatrix> patch;   ///< supports of ghosts
  std::shared_ptr<const SharedMatrix> A;  ///< of all processes: what this one owns
  Coarsening coarsening = Coarsening::aggregation;
  std::unique_ptr<MultigridSolver> solver;
  Extent extent;                 ///< of the nodes of all processes
  std::optional<Real> gyration;  ///< the least, of a body; found when it is first asked for
  DofCount script;               ///< the part's own dofs, which come before guests
  std::shared_ptr<const WholeInterface> interface;  ///< of two bodies, and their mortar; or null
  std::shared_ptr<const mortar::Mortar> mortar;
  std::vector<Index> in_mortar;  ///< of each own contact point, its number there
  /// Where the matrix is less the stiffness of forceold; null where A is as it is.
  std::shared_ptr<const GrownPart> stiffened;

  const Numbering& numbering() const { return A->numbering(); }
};

/// Of each body, the mean of its nodes on all processes, and their largest distance from it.
/// Collective.
inline std::vector<Extent> extents_of_all(const Domain& domain,
                                          const std::vector<std::vector<NodePlace>>& bodies) {
  const Index count = static_cast<Index>(bodies.size());
  Eigen::Matrix4Xd sums = Eigen::Matrix4Xd::Zero(4, count);
  for (Index k = 0; k < count; ++k)
    for (const NodePlace& n : bodies[k])
      if (domain.owns(n.dof[0])) sums.col(k) += n.x.homogeneous();
  domain.sum(sums.data(), static_cast<Index>(sums.size()));
  std::vector<Extent> extents(count);
  Vector radius = Vector::Zero(count);
  for (Index k = 0; k < count; ++k) {
    extents[k].mean = sums.col(k).hnormalized();
    for (const NodePlace& n : bodies[k])
      radius[k] = std::max(radius[k], (n.x - extents[k].mean).norm());
  }
  domain.largest(radius.data(), count);
  for (Index k = 0; k < count; ++k) extents[k].radius = radius[k];
  return extents;
}

/// Gives the own system the motions of the bodies.
inline void set_motions(SharedScene& shared, System& own) {
  const Scene& scene = *shared.scene;
  const Eigen::MatrixXd local =
      scene.system->basis().W *
      rigid_modes(scene.places(), scene.d, static_cast<Index>(scene.ndof()), shared.extent);
  const Eigen::MatrixXd modes = local(shared.numbering().own, Eigen::all);
  own.rigid_modes = [modes] { return modes; };
  if (shared.interface)  // of many bodies they take much memory
    own.body_modes = [&shared] {
      const Scene& posed = *shared.scene;
      const std::vector<NodePlace> nodes = posed.places();
      std::vector<std::vector<NodePlace>> bodies(
          static_cast<std::size_t>(shared.domain->largest(count_bodies(nodes))));
      for (const NodePlace& n : nodes) bodies[n.body].push_back(n);
      const Matrix M =
          posed.system->basis().W * body_modes(bodies, extents_of_all(*shared.domain, bodies),
                                               posed.d, static_cast<Index>(posed.ndof()));
      const std::vector<Index>& rows = shared.numbering().own;
      EntryList chosen;
      for (Index row : rows) chosen.emplace_back(static_cast<Index>(chosen.size()), row, 1);
      return Matrix(sparse(static_cast<Index>(rows.size()), M.rows(), chosen) * M);
    };
}

/// A node has tangents where some process asks for friction.   Collective.
inline void agree_on_tangents(SharedScene& shared, PointLaws& laws) {
  Scene& scene = *shared.scene;
  scene.tangents = shared.domain->largest(scene.tangents) > 0;
  if (!scene.tangents) laws.law = Law::frictionless;
}

/// Newton steps on the matrix of all, by a cycle on these levels.   Collective.
inline void set_solver(SharedScene& shared, Coarsening coarsening) {
  shared.coarsening = coarsening;
  shared.solver = std::make_unique<MultigridSolver>(
      shared.A, shared_hierarchy(shared.A, shared.A->rigid_modes(), coarsening));
}

/// The matrix of all, from the local systems, and the multigrid on it.   Collective.
inline void make_solver(SharedScene& shared) {
  Scene& scene = *shared.scene;
  const auto own = std::make_shared<SharedMatrix>(
      shared.domain, Numbering(*shared.domain, *scene.system, scene.mesh_node), *scene.system);
  shared.A = own;
  set_motions(shared, *own);
  own->inertia = inertia_of(*own);
  set_solver(shared, Coarsening::aggregation);
}

/// The scene of this process becomes one of all.   Collective.
inline void share(const Triplets& A, SharedScene& shared) {
  const Domain& domain = *shared.domain;
  Scene& scene = *shared.scene;
  shared.own_points = scene.nodes.size();
  shared.script = scene.dofs;
  if (domain.largest(has_curved_obstacle(scene)) > 0)
    follow_free_motions(A, scene.places(), shared.extent, scene, domain);
  add_ghost_points(domain, scene);
  std::unique_ptr<Dirichlet> own;
  domain.agree([&] { own = std::make_unique<Dirichlet>(A, dofs_of(points_of(scene.nodes))); });
  shared.patch = std::make_unique<PatchedMatrix>(domain, A, *own);
  domain.agree([&] { scene.assemble(shared.patch->triplets()); });
  make_solver(shared);
}

}  // namespace frictioncg
