#pragma once
#include "freefem.h"

#include <functional>
#include <memory>

#include "../core/clock.h"
#include "../core/solver.h"
#include "contact_boundary.h"
#include "matrix.h"
#include "rigid_motion.h"

namespace frictioncg {

/// A body with its contact nodes, as the script posed it: the system in local frames, and the
/// solver that keeps the factorization. Independent of the script's A and Vh once it is made. The
/// laws are not part of it: they belong to each call.
struct Scene {
  int d = 2;
  long ndof = 0;
  std::vector<BoundaryNode> nodes;  ///< contact points, one per normal of a node
  bool given_normals = false;       ///< by the script, in place of the mesh's
  bool tangents = false;            ///< some nodes have tangential laws
  std::vector<Index> mesh_node;     ///< of each dof of Vh
  /// Makes a contact node the point at which expressions are evaluated.
  std::function<void(MeshPoint*, const BoundaryNode&)> go_to;
  /// Where the nodal values of a displacement are.
  std::function<std::vector<NodePlace>()> places;
  std::unique_ptr<LocalSystem> system;
  std::unique_ptr<Solver> solver;
  double copy_seconds = 0;
  std::vector<char> held;  ///< ndof: by a Dirichlet condition

  const BoundaryNode& contact_point(Index k) const { return nodes[system->node(k).point]; }
  /// Whether contact node k is the first at its node of the mesh: a corner has several.
  bool starts_node(Index k) const {
    return k == 0 || contact_point(k).point.dof[0] != contact_point(k - 1).point.dof[0];
  }

  /// Copies A into the local frames; the nodes carry their normals and whether they have friction.
  void assemble(const Triplets& A);
};

/// Which dofs Dirichlet conditions hold: their rows of the change of basis have prescribed
/// displacements alone.
inline std::vector<char> held_dofs(const Basis& basis) {
  std::vector<char> held(basis.T.rows(), 1);
  for (Index i = 0; i < basis.T.rows(); ++i)
    for (Matrix::InnerIterator e(basis.T, i); e; ++e)
      if (e.col() < basis.local_dofs()) held[i] = 0;
  return held;
}

inline void Scene::assemble(const Triplets& A) {
  const double start = cpu_seconds();
  std::vector<ContactPoint> points;
  for (const BoundaryNode& n : nodes) points.push_back(n.point);
  const auto modes = [places = places, d = d, n = static_cast<Index>(ndof)] {
    return rigid_modes(places(), d, n);
  };
  try {
    system = std::make_unique<LocalSystem>(A, d, std::move(points), mesh_node, modes);
  } catch (const DependentNormals& e) {
    throw DependentNormals(e.point, "the obstacles at " + place(nodes[e.point], d));
  }
  solver = std::make_unique<Solver>(system->system());
  held = held_dofs(system->basis());
  copy_seconds = cpu_seconds() - start;
}

/// Which node of the mesh each dof belongs to.
template <class Space>
std::vector<Index> mesh_nodes(const Space& Vh) {
  std::vector<Index> node(Vh.NbOfDF);
  for (int k = 0; k < Vh.NbOfNodes; ++k)
    for (int i = Vh.FirstDFOfNode(k); i < Vh.LastDFOfNode(k); ++i) node[i] = k;
  return node;
}

/// The nodes that carry values of every component of the displacement.
template <class Space>
std::vector<NodePlace> node_places(const Space& Vh) {
  using D = Dimension<Space>;
  std::vector<NodePlace> places;
  std::vector<char> seen(Vh.NbOfDF, 0);
  for (int k = 0; k < Vh.Th.nt; ++k) {
    const typename D::Element K(Vh[k]);
    const Interpolation ip = D::interpolation(K);
    std::map<int, NodePlace> at_point;
    for (std::size_t e = 0; e < ip.dof.size(); ++e) {
      if (ip.coefficient[e] != 1) continue;
      NodePlace& n = at_point[ip.point[e]];
      const Fem2D::R3 x = D::position(K, ip.hat[ip.point[e]]);
      n.x = {x.x, x.y, x.z};
      n.dof[ip.component[e]] = K(ip.dof[e]);
    }
    for (const auto& [point, n] : at_point) {
      bool whole = true;
      for (int c = 0; c < D::d; ++c) whole &= n.dof[c] >= 0;
      if (!whole || seen[n.dof[0]]) continue;
      seen[n.dof[0]] = 1;
      places.push_back(n);
    }
  }
  return places;
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
  scene->nodes = contact_points(*Vh, labels);
  scene->mesh_node = mesh_nodes(*Vh);
  const CountPointer<Space> keep(Vh);
  scene->go_to = [keep](MeshPoint* mp, const BoundaryNode& node) {
    const Space* space = keep;
    Dimension<Space>::set_point(mp, *space, node);
  };
  scene->places = [keep] {
    const Space* space = keep;
    return node_places(*space);
  };
  return scene;
}

}  // namespace frictioncg
