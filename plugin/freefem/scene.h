#pragma once
#include "freefem.h"

#include "../core/clock.h"
#include "../core/solver.h"
#include "contact_boundary.h"
#include "matrix.h"
#include "pairing.h"
#include "large_turn.h"
#include "stiffness.h"

namespace frictioncg {

/// The obstacles of a scene that move, each of a label, or one of all labels.
struct MovingObstacles {
  std::vector<long> labels;            ///< empty: one obstacle
  std::vector<Eigen::Vector3d> pivot;  ///< of each
  RigidObstacles rigid;

  /// Their free components, as columns of generators.
  DenseMatrix free_motions(const RigidGenerators& generators) const {
    const Index each = generators.count();
    DenseMatrix motions(each, 0);
    for (Index q = 0; q < rigid.dofs(); ++q) {
      if (!rigid.free[q]) continue;
      motions.conservativeResize(each, motions.cols() + 1);
      motions.rightCols(1) = generators.about(pivot[q / each], q % each);
    }
    return motions;
  }
};

struct Scene;

/// One body or more with their contact nodes, as the script posed them, but for what is made of A.
struct Geometry {
  int d = 2;
  DofCount dofs;
  std::vector<BoundaryNode> nodes;    ///< contact points, one per normal of a node
  std::vector<BoundaryNode> on_mesh;  ///< those on an obstacle, with the mesh's own normals
  std::size_t beside_pairs = 0;       ///< the last of them: on an obstacle beside pairs of bodies
  std::vector<BoundaryNode> averted;  ///< left out: they face away from the normal given
  bool given_normals = false;         ///< by the script, in place of the mesh's
  bool given_weight = false;
  bool tangents = false;         ///< some nodes have tangential laws
  int unnamed_radius = -1;       ///< a component, where A looks axisymmetric without a weight
  std::vector<Index> mesh_node;  ///< of each dof
  /// Makes a contact node the point at which expressions are evaluated.
  std::function<void(MeshPoint*, const BoundaryNode&)> go_to;
  /// Where the nodal values of a displacement are.
  std::function<std::vector<NodePlace>()> places;
  std::function<const std::vector<LabelledNode>&()> labelled;  ///< facet by facet
  std::optional<Pairing> pairing;         ///< of two bodies; none where there is an obstacle alone
  mortar::Options facing;                 ///< of the two bodies, as the script has chosen them
  std::optional<MovingObstacles> moving;  ///< none where all obstacles stand still
  Displacement at;                        ///< of the geometry (ndof)
  /// The nodes and faces of the same spaces at another displacement.
  std::function<std::shared_ptr<Scene>(const Stage&)> moved_to;

  /// Of its bodies, by the mesh; found when it is first asked for.
  Real least_gyration() const {
    if (!gyration_) gyration_ = frictioncg::least_gyration(places(), d);
    return *gyration_;
  }

 private:
  mutable std::optional<Real> gyration_;
};

/// A geometry with its system in local frames, and the solver that keeps the factorization.
/// Independent of the script's A and spaces once it is made. The laws are not part of it: they
/// belong to each call.
struct Scene : Geometry {
  std::unique_ptr<LocalSystem> system;
  std::unique_ptr<Solver> solver;
  /// Of the forces of contact that turn with the geometry; null where A is as it is.
  std::unique_ptr<Stiffened> stiffened;
  double copy_seconds = 0;
  std::vector<char> held;  ///< per dof: by a Dirichlet condition

  long ndof() const { return dofs.count; }
  const BoundaryNode& contact_point(Index k) const { return nodes[system->node(k).point]; }
  /// Of the contact points, those of pairs come first.
  std::size_t paired() const { return pairing ? nodes.size() - beside_pairs : 0; }
  /// Whether contact node k touches an obstacle, not another body.
  bool on_obstacle(Index k) const { return system->node(k).point >= static_cast<Index>(paired()); }
  /// Whether contact node k is the first at its node of the mesh: a corner has several.
  bool starts_node(Index k) const {
    return k == 0 || contact_point(k).point.dof[0] != contact_point(k - 1).point.dof[0];
  }

  /// Finds the contact nodes of two bodies, beside those on an obstacle.
  void face(const Triplets& A, const mortar::Options& options, const Vector& u_old,
            bool again = false);
  /// Copies A into the local frames; the nodes carry their normals and whether they have friction.
  void assemble(const Triplets& A);
  /// The same after `before`, of which all that still holds is kept. alone: nobody else has it, and
  /// its solver goes over.
  void assemble_after(Scene& before, const Triplets& A, bool alone);
  /// The same geometry, without system and solver.
  std::shared_ptr<Scene> posed_anew() const;
  /// Where friction counts slip from, in local dofs: uold, or empty.
  Vector slip_from(const Vector& u_old) const;
  /// A itself in place of what is stiffened.
  void assemble_plain() {
    const std::unique_ptr<Stiffened> last = std::move(stiffened);
    assemble(last->plain());
  }
  /// The load of a call, and its laws, in local dofs.
  LocalIncrement increment(const LocalLoad& load, const PointLaws& laws) const;

 private:
  void make_system(const Triplets& A, const LocalSystem* before);

  /// make(), whose refusals of a contact point get the place of its node.
  template <class Make>
  auto placed(const Make& make) const {
    try {
      return make();
    } catch (const ConflictingObstacles& e) {
      throw ConflictingObstacles(e.point, place(nodes[e.point], d), e.why);
    }
  }
};

/// What bodies and obstacles may do that A does not resist, body by body, for its points on
/// obstacles: motions that their normals let slip, as far as the mesh can tell, they let slip to
/// rounding.   add: A to the freedom of bodies that the places name
template <class Add>
void follow_free_motions(Scene& scene, const std::vector<NodePlace>& places, const Extent& extent,
                         Index bodies, bool has_begun, const Add& add,
                         const SumOverProcesses& sum = {}) {
  std::vector<Index> body_at(scene.ndof(), 0), body;
  for (const NodePlace& n : places) body_at[n.dof[0]] = n.body;
  for (const BoundaryNode& p : scene.nodes) body.push_back(body_at[p.point.dof[0]]);
  FreedomOfBodies freedom_of(scene.d, extent, body, bodies);
  add(freedom_of);
  const mortar::Freedom freedom = freedom_of.freedom();
  const RigidGenerators& generators = freedom.generators;
  const DenseMatrix of_obstacles =
      scene.moving ? scene.moving->free_motions(generators) : DenseMatrix(generators.count(), 0);
  follow_by_body(scene.d, body, bodies, has_begun, scene.nodes,
                 [&](Index b, auto& points, DecidedCount decided) {
                   const DenseMatrix& own = freedom.of_body[b];
                   DenseMatrix relative(own.rows(), own.cols() + of_obstacles.cols());
                   relative << own, of_obstacles;
                   return follow_free_motions(scene.d, generators, relative, points, decided, sum);
                 });
}

/// Whether the mesh tells the normals of a curved obstacle.
inline bool has_curved_obstacle(const Scene& scene) {
  return !scene.given_normals && any_curved(scene.nodes);
}

/// Which dofs Dirichlet conditions hold: their rows of the change of basis have prescribed
/// displacements alone.
inline std::vector<char> held_dofs(const Basis& basis) {
  std::vector<char> held(basis.T.rows(), 1);
  for (Index i = 0; i < basis.T.rows(); ++i)
    for (Matrix::InnerIterator e(basis.T, i); e; ++e)
      if (e.col() < basis.local_dofs() && e.value() != 0) held[i] = 0;
  return held;
}

inline std::shared_ptr<Scene> Scene::posed_anew() const {
  auto scene = std::make_shared<Scene>();
  static_cast<Geometry&>(*scene) = *this;
  return scene;
}

inline void Scene::face(const Triplets& A, const mortar::Options& options, const Vector& u_old,
                        bool again) {
  const double start = cpu_seconds();
  const std::vector<BoundaryNode> of_obstacle = std::move(nodes);
  nodes = pairing->face(A, d, options, u_old, of_obstacle, places, again);
  nodes.insert(nodes.end(), of_obstacle.begin(), of_obstacle.end());
  beside_pairs = of_obstacle.size();
  copy_seconds = cpu_seconds() - start;
}

inline void Scene::assemble(const Triplets& A) {
  const double start = cpu_seconds();
  make_system(A, nullptr);
  solver = std::make_unique<Solver>(system->system());
  copy_seconds += cpu_seconds() - start;
}

inline void Scene::assemble_after(Scene& before, const Triplets& A, bool alone) {
  const double start = cpu_seconds();
  make_system(A, before.system.get());
  if (alone) {
    before.solver->renew(system->system());
    solver = std::move(before.solver);
  } else {
    solver = std::make_unique<Solver>(system->system());
  }
  copy_seconds += cpu_seconds() - start;
}

inline void Scene::make_system(const Triplets& A, const LocalSystem* before) {
  std::vector<ContactPoint> points;
  for (const BoundaryNode& n : nodes) points.push_back(n.point);
  const Index n = static_cast<Index>(ndof());
  const auto modes = [places = places, d = d, n] { return rigid_modes(places(), d, n); };
  const auto each = [places = places, d = d, n] { return body_modes(places(), d, n); };
  system = placed([&] {
    if (pairing) return pairing->system(A, d, std::move(points), mesh_node, modes, each, before);
    if (moving)
      return std::make_unique<LocalSystem>(A, d, std::move(points), mesh_node, moving->rigid, modes,
                                           each, before);
    return std::make_unique<LocalSystem>(A, d, std::move(points), mesh_node, modes, before);
  });
  held = held_dofs(system->basis());
}

inline Vector Scene::slip_from(const Vector& u_old) const {
  if (u_old.size() == 0) return {};
  Vector w = system->to_local(u_old);
  const std::vector<Index>& first = system->system()->first;
  for (Index k = 0; k < system->nodes(); ++k)
    for (Index i = first[k] + 1; i < first[k + 1]; ++i) {
      const BoundaryNode& node = contact_point(k);
      for (int c = 0; c < d; ++c)
        if (node.slid[c] != 0) w[i] -= system->basis().W.coeff(i, node.point.dof[c]) * node.slid[c];
    }
  return w;
}

inline LocalIncrement Scene::increment(const LocalLoad& load, const PointLaws& laws) const {
  return placed([&] { return system->increment(load, laws); });
}

}  // namespace frictioncg
