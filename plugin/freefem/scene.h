#pragma once
#include "freefem.h"

#include <functional>
#include <memory>

#include "../core/clock.h"
#include "../core/solver.h"
#include "contact_boundary.h"
#include "matrix.h"

namespace frictioncg {

/// A contact problem as the script posed it: its nodes, its system in local frames, and the solver
/// that keeps the factorization. Independent of the script's A and Vh once it is made.
struct Scene {
  int d = 2;
  long ndof = 0;
  std::vector<BoundaryNode> nodes;
  std::vector<Index> mesh_node;  ///< of each dof of Vh
  /// Makes a contact node the point at which expressions are evaluated.
  std::function<void(MeshPoint*, const BoundaryNode&)> go_to;
  std::unique_ptr<LocalSystem> system;
  std::unique_ptr<Solver> solver;
  Law law = Law::frictionless;
  bool bilateral = false;
  Vector gap, mu, limit;  ///< at the nodes; limit is a force
  double copy_seconds = 0;

  /// Copies A into the local frames; the nodes carry their normals and whether they have friction.
  void assemble(const Triplets& A) {
    const double start = cpu_seconds();
    std::vector<ContactPoint> points;
    for (const BoundaryNode& n : nodes) points.push_back(n.point);
    system = std::make_unique<LocalSystem>(A, d, std::move(points), mesh_node);
    solver = std::make_unique<Solver>(system->system());
    copy_seconds = cpu_seconds() - start;
  }

  /// The increment under the load b from the state u_old (ndof, or empty for 0).
  LocalIncrement increment(const Vector& b, const Vector& u_old) const {
    return system->increment(b, u_old, {law, bilateral, gap, law == Law::coulomb ? mu : limit});
  }
};

/// Which node of the mesh each dof belongs to.
template <class Space>
std::vector<Index> mesh_nodes(const Space& Vh) {
  std::vector<Index> node(Vh.NbOfDF);
  for (int k = 0; k < Vh.NbOfNodes; ++k)
    for (int i = Vh.FirstDFOfNode(k); i < Vh.LastDFOfNode(k); ++i) node[i] = k;
  return node;
}

/// The geometry of a scene: the contact nodes of the labels, and how to evaluate expressions there.
template <class V>
std::shared_ptr<Scene> make_scene(typename V::pfes* pVh, const std::vector<long>& labels) {
  using Space = typename V::FESpace;
  Space* Vh = pVh && *pVh ? static_cast<Space*>(**pVh) : nullptr;
  if (!Vh) throw IllegalInput("Vh is not a finite-element space");
  auto scene = std::make_shared<Scene>();
  scene->d = Dimension<Space>::d;
  scene->ndof = Vh->NbOfDF;
  scene->nodes = contact_nodes(*Vh, labels);
  scene->mesh_node = mesh_nodes(*Vh);
  const CountPointer<Space> keep(Vh);
  scene->go_to = [keep](MeshPoint* mp, const BoundaryNode& node) {
    const Space* space = keep;
    Dimension<Space>::set_point(mp, *space, node);
  };
  return scene;
}

}  // namespace frictioncg
