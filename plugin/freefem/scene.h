#pragma once
#include "freefem.h"

#include <functional>
#include <memory>
#include <optional>

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
};

/// One body or more with their contact nodes, as the script posed them: the system in local frames,
/// and the solver that keeps the factorization. Independent of the script's A and spaces once it is
/// made. The laws are not part of it: they belong to each call.
struct Scene {
  int d = 2;
  DofCount dofs;
  std::vector<BoundaryNode> nodes;    ///< contact points, one per normal of a node
  std::vector<BoundaryNode> on_mesh;  ///< those on an obstacle, with the mesh's own normals
  std::size_t beside_pairs = 0;       ///< the last of them: on an obstacle beside pairs of bodies
  std::vector<BoundaryNode> averted;  ///< left out: they face away from the normal given
  bool given_normals = false;         ///< by the script, in place of the mesh's
  bool tangents = false;              ///< some nodes have tangential laws
  int unnamed_radius = -1;            ///< a component, where A looks axisymmetric without a weight
  std::vector<Index> mesh_node;       ///< of each dof
  /// Makes a contact node the point at which expressions are evaluated.
  std::function<void(MeshPoint*, const BoundaryNode&)> go_to;
  /// Where the nodal values of a displacement are.
  std::function<std::vector<NodePlace>()> places;
  std::function<std::vector<LabelledNode>()> labelled;  ///< facet by facet
  std::unique_ptr<Pairing> pairing;  ///< of two bodies; null where there is an obstacle alone
  mortar::Options facing;            ///< of the two bodies, as the script has chosen them
  std::unique_ptr<MovingObstacles> moving;  ///< null where all obstacles stand still
  std::unique_ptr<LocalSystem> system;
  std::unique_ptr<Solver> solver;
  Displacement at;  ///< of the geometry (ndof)
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

  /// Of its bodies, by the mesh; found when it is first asked for.
  Real least_gyration() const {
    if (!gyration_) gyration_ = frictioncg::least_gyration(places(), d);
    return *gyration_;
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

  mutable std::optional<Real> gyration_;

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

/// Which dofs Dirichlet conditions hold: their rows of the change of basis have prescribed
/// displacements alone.
inline std::vector<char> held_dofs(const Basis& basis) {
  std::vector<char> held(basis.T.rows(), 1);
  for (Index i = 0; i < basis.T.rows(); ++i)
    for (Matrix::InnerIterator e(basis.T, i); e; ++e)
      if (e.col() < basis.local_dofs()) held[i] = 0;
  return held;
}

inline std::shared_ptr<Scene> Scene::posed_anew() const {
  auto scene = std::make_shared<Scene>();
  scene->d = d;
  scene->dofs = dofs;
  scene->nodes = nodes;
  scene->on_mesh = on_mesh;
  scene->beside_pairs = beside_pairs;
  scene->averted = averted;
  scene->given_normals = given_normals;
  scene->tangents = tangents;
  scene->mesh_node = mesh_node;
  scene->go_to = go_to;
  scene->places = places;
  scene->labelled = labelled;
  scene->at = at;
  scene->facing = facing;
  if (pairing) scene->pairing = std::make_unique<Pairing>(*pairing);
  if (moving) scene->moving = std::make_unique<MovingObstacles>(*moving);
  scene->gyration_ = gyration_;
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

/// Which node of the mesh each dof belongs to.
template <class Space>
std::vector<Index> mesh_nodes(const Space& Vh) {
  std::vector<Index> node(Vh.NbOfDF);
  for (int k = 0; k < Vh.NbOfNodes; ++k)
    for (int i = Vh.FirstDFOfNode(k); i < Vh.LastDFOfNode(k); ++i) node[i] = k;
  return node;
}

/// The nodes that carry values of every component of the displacement. Elements with nothing new
/// are passed over: most of them, in 3D.
template <class Space>
std::vector<NodePlace> node_places(const Placement<Space>& placement) {
  using D = Dimension<Space>;
  const Space& Vh = placement.space();
  const std::vector<Index> body = body_of_element(Vh.Th, D::d);
  std::vector<NodePlace> places, at_point;
  std::vector<char> seen(Vh.NbOfDF, 0);
  Interpolation ip;
  for (int k = 0; k < Vh.Th.nt; ++k) {
    const typename D::Element K(Vh[k]);
    bool news = false;
    for (int i = 0; i < K.NbDoF() && !news; ++i) news = !seen[K(i)];
    if (!news) continue;
    D::interpolate(K, ip);
    at_point.assign(ip.hat.size(), NodePlace());
    for (std::size_t e = 0; e < ip.dof.size(); ++e)
      if (ip.coefficient[e] == 1) at_point[ip.point[e]].dof[ip.component[e]] = K(ip.dof[e]);
    for (std::size_t p = 0; p < at_point.size(); ++p) {
      NodePlace& n = at_point[p];
      bool whole = true;
      for (int c = 0; c < D::d; ++c) whole &= n.dof[c] >= 0;
      if (!whole || seen[n.dof[0]]) continue;
      const Fem2D::R3 x = placement.node(k, ip.hat[p], n.dof);
      n.x = {x.x, x.y, x.z};
      n.body = body[k];
      places.push_back(n);
      seen[n.dof[0]] = 1;
    }
    for (int i = 0; i < K.NbDoF(); ++i) seen[K(i)] = 1;
  }
  return places;
}

/// Makes a node the point at which expressions are evaluated: where it has been moved to, and in
/// its element, by which functions on the mesh are read.
template <class FESpaceType>
void go_to(MeshPoint* mp, const Placement<FESpaceType>& Vh, const BoundaryNode& node) {
  Dimension<FESpaceType>::set_point(mp, Vh.mesh(), node, Vh(node.element, node.hat) + node.aside);
}

/// How to evaluate expressions at the nodes of a space, and where they are.
template <class FESpaceType>
void observe(const Placement<FESpaceType>& Vh, Scene& scene) {
  scene.mesh_node = mesh_nodes(Vh.space());
  scene.go_to = [Vh](MeshPoint* mp, const BoundaryNode& node) { frictioncg::go_to(mp, Vh, node); };
  const auto places = std::make_shared<std::vector<NodePlace>>();  // found when first asked for
  scene.places = [Vh, places] {
    if (places->empty()) *places = node_places(Vh);
    return *places;
  };
  scene.labelled = [Vh] { return labelled_nodes(Vh); };
}

/// Normals that motions of a body leave tangential, as far as the mesh can tell, do so exactly.
template <class FESpaceType>
void follow_motions(const FESpaceType& Vh, std::vector<BoundaryNode>& points) {
  if (!any_curved(points)) return;
  const std::vector<Index> of_element = body_of_element(Vh.Th, Dimension<FESpaceType>::d);
  std::vector<Index> body;
  for (const BoundaryNode& p : points) body.push_back(of_element[p.element]);
  follow_motions(Dimension<FESpaceType>::d, body, *std::max_element(body.begin(), body.end()) + 1,
                 points);
}

/// One body and an obstacle, at the contact points.
template <class FESpaceType>
std::shared_ptr<Scene> obstacle_scene(const Placement<FESpaceType>& Vh,
                                      std::vector<BoundaryNode> points) {
  auto scene = std::make_shared<Scene>();
  scene->d = Dimension<FESpaceType>::d;
  scene->dofs = dofs_of(Vh.space().NbOfDF);
  scene->nodes = std::move(points);
  observe(Vh, *scene);
  return scene;
}

/// The contact points of the labels, in one process.
template <class FESpaceType>
std::vector<BoundaryNode> obstacle_points(const NamedSpace<FESpaceType>& space,
                                          const std::vector<long>& labels) {
  if (labels.empty()) return {};
  const Boundary boundary = boundary_of(space, labels);
  std::vector<BoundaryNode> points =
      contact_points(Dimension<FESpaceType>::d, boundary, boundary.nodes.size());
  follow_motions(space.Vh.space(), points);
  return points;
}
template <class FESpaceType>
std::shared_ptr<Scene> obstacle_scene(const Placement<FESpaceType>& Vh,
                                      const std::vector<long>& labels) {
  return obstacle_scene(Vh, obstacle_points(before_obstacle(Vh), labels));
}

/// The labels of two bodies; those that this process's part of the meshes has, and all pairs.
struct PairLabels {
  PairLabels(std::vector<long> slave_, std::vector<long> master_)
      : slave(std::move(slave_)),
        master(std::move(master_)),
        pairs(mortar::label_pairs(slave, master)) {}

  std::vector<long> slave, master;
  std::vector<mortar::LabelPair> pairs;
  bool of_part = false;  ///< of meshes that other processes have parts of
};

/// A facet has one partner: a body, or the obstacle.
inline void refuse_second_role(const std::vector<long>& obstacle, const std::vector<long>& side,
                               const char* role) {
  for (long label : obstacle)
    if (std::count(side.begin(), side.end(), label))
      throw IllegalInput("label " + std::to_string(label) + " is " + role +
                         " and on the obstacle; a boundary touches one of them: give its parts "
                         "labels of their own");
}

/// Two bodies in one space: two parts of a mesh, or the faces of a crack; obstacle: labels beside
/// them.
template <class FESpaceType>
std::shared_ptr<Scene> pair_scene(const Placement<FESpaceType>& Vh, const PairLabels& labels,
                                  const std::vector<long>& obstacle = {}) {
  auto scene = std::make_shared<Scene>();
  scene->d = Dimension<FESpaceType>::d;
  scene->dofs = dofs_of(Vh.space().NbOfDF);
  refuse_second_role(obstacle, labels.slave, "slave");
  refuse_second_role(obstacle, labels.master, "master");
  scene->nodes = obstacle_points(before_obstacle(Vh), obstacle);
  const NamedSpace<FESpaceType> space{Vh, "Vh", "the mesh", pair_inside};
  InterfaceBuilder faces(labels.pairs, labels.of_part);
  faces.add_slave(BoundaryNodes<FESpaceType>(space, labels.slave));
  faces.add_master(BoundaryNodes<FESpaceType>(space, labels.master), 0);
  scene->pairing = std::make_unique<Pairing>(faces.take());
  observe(Vh, *scene);
  return scene;
}

/// Which labels of an obstacle are on which of two meshes.
template <class FESpaceType>
std::array<std::vector<long>, 2> by_mesh(const FESpaceType& V1, const FESpaceType& V2,
                                         const std::vector<long>& obstacle) {
  std::array<std::vector<long>, 2> labels;
  if (obstacle.empty()) return labels;
  const std::set<long> first = labels_of_boundary(V1), second = labels_of_boundary(V2);
  for (long label : obstacle) {
    const bool in_first = first.count(label) > 0, in_second = second.count(label) > 0;
    if (in_first == in_second)
      throw IllegalInput(
          "obstacle has the label " + std::to_string(label) +
          (in_first ? ", which is on the mesh of V1 and on that of V2; give one of them another "
                      "label, by change(Th, label=...)"
                    : ", which is neither on the mesh of V1 nor on that of V2"));
    labels[in_first ? 0 : 1].push_back(label);
  }
  return labels;
}

/// The contact points of an obstacle beside two bodies in spaces of their own.
template <class FESpaceType>
std::vector<BoundaryNode> obstacle_points(const Placement<FESpaceType>& V1,
                                          const Placement<FESpaceType>& V2,
                                          const PairLabels& labels,
                                          const std::vector<long>& obstacle) {
  const auto [first, second] = by_mesh(V1.space(), V2.space(), obstacle);
  refuse_second_role(first, labels.slave, "slave");
  refuse_second_role(second, labels.master, "master");
  std::vector<BoundaryNode> points =
      obstacle_points(before_obstacle(V1, "V1", "the mesh of V1"), first);
  for (BoundaryNode& p : obstacle_points(before_obstacle(V2, "V2", "the mesh of V2"), second)) {
    for (int c = 0; c < Dimension<FESpaceType>::d; ++c) p.point.dof[c] += V1.space().NbOfDF;
    p.space = 1;
    points.push_back(std::move(p));
  }
  return points;
}

/// Two bodies in spaces of their own: the dofs of V2 follow those of V1.
template <class FESpaceType>
std::shared_ptr<Scene> pair_scene(const Placement<FESpaceType>& V1,
                                  const Placement<FESpaceType>& V2, const PairLabels& labels,
                                  const std::vector<long>& obstacle = {}) {
  auto scene = std::make_shared<Scene>();
  scene->d = Dimension<FESpaceType>::d;
  const Index offset = V1.space().NbOfDF;
  scene->dofs = dofs_of(offset, V2.space().NbOfDF);
  scene->nodes = obstacle_points(V1, V2, labels, obstacle);
  InterfaceBuilder faces(labels.pairs, labels.of_part);
  faces.add_slave(
      BoundaryNodes<FESpaceType>({V1, "V1", "the mesh of V1", pair_inside}, labels.slave));
  faces.add_master(
      BoundaryNodes<FESpaceType>({V2, "V2", "the mesh of V2", pair_inside}, labels.master), offset);
  scene->pairing = std::make_unique<Pairing>(faces.take());
  observe(V1, *scene);
  for (Index node : mesh_nodes(V2.space())) scene->mesh_node.push_back(V1.space().NbOfNodes + node);
  scene->go_to = [V1, V2](MeshPoint* mp, const BoundaryNode& node) {
    go_to(mp, node.space == 0 ? V1 : V2, node);
  };
  const auto known = std::make_shared<std::vector<NodePlace>>();
  scene->places = [of_first = scene->places, V2, known, offset, d = scene->d] {
    if (!known->empty()) return *known;
    std::vector<NodePlace> places = of_first();
    Index bodies = 0;
    for (const NodePlace& n : places) bodies = std::max(bodies, n.body + 1);
    for (NodePlace n : node_places(V2)) {
      n.body += bodies;
      for (int c = 0; c < d; ++c) n.dof[c] += offset;
      places.push_back(n);
    }
    *known = places;
    return places;
  };
  scene->labelled = [of_first = scene->labelled, V2, offset, d = scene->d] {
    std::vector<LabelledNode> all = of_first();
    for (LabelledNode n : labelled_nodes(V2)) {
      n.space = 1;
      for (int c = 0; c < d; ++c) n.dof[c] += offset;
      all.push_back(n);
    }
    return all;
  };
  return scene;
}

}  // namespace frictioncg
