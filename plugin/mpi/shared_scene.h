#pragma once
#include "../freefem/freefem.h"

#include "../freefem/call.h"
#include "ghosts.h"
#include "hierarchy.h"
#include "multigrid/multigrid_solver.h"

namespace frictioncg {

/// One body of all processes: the overlapping part of this one, as the script has it, and the
/// system that it owns of the whole.
struct SharedScene {
  std::shared_ptr<const Domain> domain;
  int number = 0;                         ///< as that of a domain
  std::shared_ptr<Scene> scene;           ///< overlapping; contact points of ghosts included
  std::size_t own_points = 0;             ///< of the contact points; those of ghosts follow
  std::unique_ptr<PatchedMatrix> patch;   ///< supports of ghosts
  std::shared_ptr<const SharedMatrix> A;  ///< of all processes
  SystemPtr system;                       ///< what this process owns
  std::unique_ptr<MultigridSolver> solver;
  Extent extent;  ///< of the nodes of all processes

  const Numbering& numbering() const { return A->numbering(); }
};

/// The mean of the nodes of all processes, and their largest distance from it.
inline Extent extent_of_all(const Domain& domain, const std::vector<NodePlace>& nodes) {
  Eigen::Vector4d sums = Eigen::Vector4d::Zero();
  for (const NodePlace& n : nodes)
    if (domain.owns(n.dof[0])) {
      sums.head<3>() += position(n);
      sums[3] += 1;
    }
  domain.sum(sums.data(), 4);
  Extent e;
  e.mean = sums.head<3>() / sums[3];
  for (const NodePlace& n : nodes) e.radius = std::max(e.radius, (position(n) - e.mean).norm());
  e.radius = domain.largest(e.radius);
  return e;
}

/// The part of the local system that this process owns; finds the extent.   Collective.
inline SystemPtr own_system(SharedScene& shared) {
  const LocalSystem& local = *shared.scene->system;
  const Numbering& numbering = shared.numbering();
  const auto own = std::make_shared<System>();
  own->dimension = shared.scene->d;
  own->D = shared.A->own_part(local.system()->D);
  own->weight = shared.A->own_part(local.system()->weight);
  own->first = numbering.own_first;
  own->processes = shared.A;
  const std::vector<NodePlace> places = shared.scene->places();
  shared.extent = extent_of_all(*shared.domain, places);
  const Index n = static_cast<Index>(shared.scene->ndof());
  const Eigen::MatrixXd modes =
      local.basis().W * rigid_modes(places, shared.scene->d, n, shared.extent);
  Eigen::MatrixXd own_modes(own->dofs(), modes.cols());
  for (Index k = 0; k < modes.cols(); ++k) own_modes.col(k) = shared.A->own_part(modes.col(k));
  own->rigid_modes = [own_modes] { return own_modes; };
  return own;
}

/// The scene of this process becomes one of all.   Collective.
inline void share(const Triplets& A, SharedScene& shared) {
  const Domain& domain = *shared.domain;
  Scene& scene = *shared.scene;
  shared.own_points = scene.nodes.size();
  add_ghost_points(domain, scene);
  std::unique_ptr<Dirichlet> own;
  domain.agree([&] {
    std::vector<ContactPoint> points;
    for (const BoundaryNode& n : scene.nodes) points.push_back(n.point);
    own = std::make_unique<Dirichlet>(A, points);
  });
  shared.patch = std::make_unique<PatchedMatrix>(domain, A, *own);
  domain.agree([&] { scene.assemble(shared.patch->triplets(A)); });
  shared.A = std::make_shared<SharedMatrix>(
      shared.domain, Numbering(domain, *scene.system, scene.mesh_node), *scene.system);
  shared.system = own_system(shared);
  shared.solver = std::make_unique<MultigridSolver>(
      shared.system, std::make_unique<SharedHierarchy>(shared.A, shared.system->rigid_modes()));
}

/// As scales_of, but for the extent, which is that of the body.   Collective.
inline Scales scales_of_all(const SharedScene& shared, const Vector& b) {
  const Domain& domain = *shared.domain;
  const Vector& D = shared.system->D;
  Real load = 0, diagonal[] = {D.sum(), Real(D.size())};
  for (Index i = 0; i < domain.dofs(); ++i)
    if (domain.owns(i) && !shared.scene->held[i]) load = std::max(load, std::abs(b[i]));
  domain.sum(diagonal, 2);
  Scales s;
  s.extent = 2 * shared.extent.radius;
  s.stiffness = diagonal[0] / diagonal[1];
  s.stiffest = domain.largest(D.size() > 0 ? D.maxCoeff() : 0);
  s.moved = domain.largest(load) / s.stiffness;
  return s;
}

/// What b has at the Dirichlet dofs of all processes, which are taken for one body.   Collective.
inline Leftover leftover_of_all(const SharedScene& shared, const Vector& b) {
  const Domain& domain = *shared.domain;
  Leftover left;
  for (const NodePlace& n : shared.scene->places())
    if (domain.owns(n.dof[0])) left.add(*shared.scene, b, n);
  Real counts[] = {left.loaded, left.empty};
  domain.sum(counts, 2);
  left.loaded = counts[0];
  left.empty = counts[1];
  left.most = domain.largest(left.most);
  for (int c = 0; c < 3; ++c) {
    left.largest[c] = domain.largest(left.largest[c]);
    left.least[c] = -domain.largest(-left.least[c]);
  }
  return left;
}

/// As in one process.   Collective.
inline Real check_data(const SharedScene& shared, const Vector& b, const Vector& u0) {
  const Domain& domain = *shared.domain;
  const Scene& scene = *shared.scene;
  const Scales s = scales_of_all(shared, b);
  domain.agree([&] {
    refuse_data_without_row(scene, b, s);
    refuse_huge_data(scene, b, u0, s);
  });
  const long i = largest_data(scene, b, u0);
  if (!is_tiny(domain.largest(i < 0 ? 0 : std::abs(u0[i])), s)) return 0;
  const Leftover left = leftover_of_all(shared, b);
  domain.agree([&] {
    if (i >= 0) refuse_tiny_data(scene, b, u0, i, s, left);
  });
  return left.most;
}

/// The increment over the own dofs and nodes, from that of the local system.   Collective.
inline Increment own_increment(const SharedScene& shared, const LocalIncrement& local,
                               const LocalLoad& load) {
  const Numbering& numbering = shared.numbering();
  const auto of_nodes = [&](const Vector& all) {
    Vector own(static_cast<Index>(numbering.own_nodes.size()));
    for (Index k = 0; k < own.size() && all.size() > 0; ++k) own[k] = all[numbering.own_nodes[k]];
    return own;
  };
  Increment own = local.increment;
  own.gap = of_nodes(local.increment.gap);
  if (own.law == Law::coulomb) own.mu = of_nodes(local.increment.mu);
  if (own.law == Law::tresca) own.g = of_nodes(local.increment.g);
  LocalLoad own_load;
  own_load.external = shared.A->own_part(load.external);
  own_load.total = shared.A->own_part(load.total);
  own_load.F = shared.A->own_part(load.F);
  own_load.sizes = shared.A->own_part(load.sizes);
  set_load(own_load, *shared.system, own);
  return own;
}

}  // namespace frictioncg
