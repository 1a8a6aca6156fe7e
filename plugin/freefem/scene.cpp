#include "scene.h"

#include <mutex>

#include "../core/assembly/turning_normals.h"
#include "../core/clock.h"
#include "checks.h"

namespace frictioncg {

namespace {

/// make(), by whichever copy is called first, on whichever thread, for all of them.
template <class Make>
auto once(Make make) {
  struct Made {
    std::once_flag flag;
    decltype(make()) value;
  };
  const auto made = std::make_shared<Made>();
  return [make = std::move(make), made]() -> const decltype(make())& {
    std::call_once(made->flag, [&] { made->value = make(); });
    return made->value;
  };
}

/// Adds the contact points of the labels, in one process. Normals that motions of a body leave
/// tangential, as far as the mesh can tell, do so exactly.
void add_obstacle_points(const Space& Vh, const std::vector<long>& labels,
                         std::vector<BoundaryNode>& all) {
  if (labels.empty()) return;
  Boundary boundary = Vh.boundary(labels), begun;
  if (Vh.begun()) begun = Vh.begun()->boundary(labels);
  const std::size_t count = boundary.nodes.size();
  std::vector<BoundaryNode> points =
      contact_points(Vh.d, std::move(boundary), Vh.begun() ? &begun : nullptr, count);
  if (any_curved(points)) {
    const std::vector<Index> of_element = Vh.body_of_element();
    std::vector<Index> body;
    for (const BoundaryNode& p : points) body.push_back(of_element[p.element]);
    follow_motions(Vh.d, body, count_of(body), Vh.begun() != nullptr, points);
  }
  std::move(points.begin(), points.end(), std::back_inserter(all));
}

/// A facet has one partner: a body, or the obstacle.
void refuse_second_role(const std::vector<long>& obstacle, const std::vector<long>& side,
                        const char* role) {
  for (long label : obstacle)
    if (std::count(side.begin(), side.end(), label))
      refuse("label ", label, " is ", role,
             " and on the obstacle; a boundary touches one of them: give its parts "
             "labels of their own");
}

/// Which labels of an obstacle are on which of the meshes.
std::vector<std::vector<long>> by_mesh(const Spaces& spaces, const std::vector<long>& obstacle) {
  std::vector<std::vector<long>> labels(spaces.size());
  if (obstacle.empty() || spaces.size() == 1) {
    labels.front() = obstacle;
    return labels;
  }
  const std::set<long> first = spaces.front()->labels(), second = spaces.back()->labels();
  for (long label : obstacle) {
    const bool in_first = first.count(label) > 0, in_second = second.count(label) > 0;
    if (in_first == in_second)
      refuse("obstacle has the label ", label,
             (in_first ? ", which is on the mesh of V1 and on that of V2; give one of them another "
                         "label, by change(Th, label=...)"
                       : ", which is neither on the mesh of V1 nor on that of V2"));
    labels[in_first ? 0 : 1].push_back(label);
  }
  return labels;
}

/// -p dn/dx of each node before an obstacle, in the dofs of the script. Of the mesh's own normals,
/// which turn as the body bends, its stiffness alone: on humps two states of a step take turns
/// where it takes stiffness off. None of obstacles that move: what body and obstacle do together
/// turns nothing.
EntryList turning_forces(const Scene& scene) {
  const std::vector<BoundaryNode>& nodes = scene.nodes;
  const std::size_t first = scene.paired();
  if (scene.moving || first == nodes.size()) return {};
  std::vector<ObstaclePoint> points;
  for (std::size_t k = first; k < nodes.size(); ++k) {
    points.push_back({nodes[k].x, nodes[k].point.normal, {}});
    for (const AdjacentFacet& f : nodes[k].facets) {
      const std::size_t of_both_meshes = 2 * f.place + (f.space->offset > 0);
      points.back().facets.push_back({of_both_meshes, f.share});
    }
  }
  const std::vector<Eigen::Matrix3d> turning = turning_of_normals(points);
  const auto same_node = [&](std::size_t one, std::size_t other) {
    return nodes[one].point.dof == nodes[other].point.dof;
  };
  EntryList entries;
  for (std::size_t k = first; k < nodes.size(); ++k) {
    // the force of a node in a corner does not tell which of its normals has it
    const bool in_corner =
        (k > first && same_node(k, k - 1)) || (k + 1 < nodes.size() && same_node(k, k + 1));
    const ContactPoint& p = nodes[k].point;
    Real pressing = 0;
    for (int c = 0; c < scene.d; ++c) pressing -= scene.force[p.dof[c]] * p.normal[c];
    Eigen::Matrix3d dn = turning[k - first];
    if (in_corner || !(pressing > 0) || dn.isZero(0)) continue;
    if (!scene.given_normals) dn = positive_part(dn);
    for (int a = 0; a < scene.d; ++a)
      for (int b = 0; b < scene.d; ++b)
        if (dn(a, b) != 0) entries.emplace_back(p.dof[a], p.dof[b], -pressing * dn(a, b));
  }
  return entries;
}

}  // namespace

void Scene::assemble(const Triplets& A, Scene* before, bool alone) {
  const Stopwatch watch(copy_seconds);
  std::vector<ContactPoint> points = points_of(nodes);
  const LocalSystem* const last = before ? before->system.get() : nullptr;
  const Index n = static_cast<Index>(ndof());
  BodyShape shape;
  shape.rigid_modes = [places = places, d = d, n] { return rigid_modes(places(), d, n); };
  shape.slenderness = [places = places, d = d] { return slenderness(places(), d); };
  if (pairing || moving)
    shape.body_modes = [places = places, d = d, n] { return body_modes(places(), d, n); };
  const RigidObstacles none;
  system = placed([&] {
    if (pairing) return pairing->system(A, std::move(points), mesh_node, shape, last);
    return std::make_unique<LocalSystem>(A, d, std::move(points), mesh_node, shape, last,
                                         moving ? moving->rigid : none);
  });
  unit_load_.resize(0);
  refuse_component_blocks(*this, A);
  refuse_lost_penalties(*this, A);
  if (alone) before->solver->renew(system->system());
  solver = alone ? std::move(before->solver) : std::make_unique<Solver>(system->system());
}

Vector Scene::slip_from(const Vector& u_old) const {
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

LocalIncrement Scene::increment(const LocalLoad& load, const PointLaws& laws) const {
  return placed([&] { return system->increment(load, laws); });
}

DofCount dofs_of(const Spaces& spaces) {
  const Space& last = *spaces.back();
  return {last.offset + last.dofs(), last.offset};
}

std::shared_ptr<Scene> scene_on(const Spaces& spaces, std::vector<BoundaryNode> points) {
  auto scene = std::make_shared<Scene>();
  scene->d = spaces.front()->d;
  scene->dofs = dofs_of(spaces);
  scene->nodes = std::move(points);
  scene->spaces = spaces;
  scene->at = spaces.front()->stage.at;
  for (const SpacePtr& V : spaces) V->add_mesh_nodes(scene->mesh_node);
  scene->places = once([spaces] {
    std::vector<NodePlace> places;
    for (const SpacePtr& V : spaces) V->add_places(places);
    return places;
  });
  return scene;
}

void check_stage(const Stage& stage, const DofCount& dofs) {
  if (stage.at) check_vector(*stage.at, "at", dofs);
  if (stage.begun) check_vector(*stage.begun, "uold", dofs);
}

std::shared_ptr<Scene> scene_at(const Stage& stage, const Spaces& any_stage, const Sides& sides) {
  check_stage(stage, dofs_of(any_stage));
  const Spaces spaces = at(stage, any_stage);
  const bool two_bodies = !sides.master.empty();
  const auto labels = by_mesh(spaces, two_bodies ? sides.obstacle : sides.slave);
  if (two_bodies) {
    refuse_second_role(labels.front(), sides.slave, "slave");
    refuse_second_role(labels.back(), sides.master, "master");
  }
  std::vector<BoundaryNode> points;
  for (std::size_t k = 0; k < spaces.size(); ++k)
    add_obstacle_points(*spaces[k], labels[k], points);
  const std::shared_ptr<Scene> scene = scene_on(spaces, std::move(points));
  scene->sides = sides;
  if (two_bodies)
    scene->pairing.emplace(
        interface_of(spaces, {sides.slave, sides.master,
                              mortar::label_pairs(sides.slave, sides.master, spaces.size() == 1)}));
  return scene;
}

void follow_free_motions(const Triplets& A, const std::vector<NodePlace>& places,
                         const Extent& extent, Scene& scene, const Processes& all) {
  const NodeDofs at_points = dofs_of(points_of(scene.nodes));
  const std::vector<Index> body = body_of_nodes(at_points, places, scene.d, scene.ndof());
  const Index bodies = static_cast<Index>(all.largest(count_bodies(places)));
  std::unique_ptr<const Dirichlet> dirichlet;
  all.agree([&] { dirichlet = std::make_unique<Dirichlet>(A, at_points); });
  const mortar::Freedom freedom =
      freedom_of(A, *dirichlet, places, scene.d, extent, body, bodies, all);
  const RigidGenerators& generators = freedom.generators;
  const Index each = generators.count();
  DenseMatrix of_obstacles(each, 0);  // their free components
  for (Index q = 0; scene.moving && q < scene.moving->rigid.dofs(); ++q) {
    if (!scene.moving->rigid.free[q]) continue;
    of_obstacles.conservativeResize(each, of_obstacles.cols() + 1);
    of_obstacles.rightCols(1) = generators.about(scene.moving->pivot[q / each], q % each);
  }
  const auto sum = [&](Real* values, Index count) { all.sum(values, count); };
  const bool has_begun = scene.spaces.front()->begun() != nullptr;
  follow_by_body(scene.d, body, bodies, has_begun, scene.nodes,
                 [&](Index b, std::vector<PointNormal>& points, DecidedSlips decided) {
                   const DenseMatrix& own = freedom.of_body[b];
                   DenseMatrix relative(own.rows(), own.cols() + of_obstacles.cols());
                   relative << own, of_obstacles;
                   return follow_free_motions(scene.d, generators, relative, points, decided, sum);
                 });
}

Real told_by_mesh(const Scene& scene, Real of_pairs, const System& system) {
  Real curved_weight_untold[] = {Real(has_curved_obstacle(scene)), 0, 0};
  auto& [curved, weight, all] = curved_weight_untold;
  for (std::size_t k = scene.paired(); k < scene.nodes.size(); ++k) {
    weight += scene.nodes[k].weight;
    all += scene.nodes[k].weight * untold(scene.nodes[k].turn);
  }
  system.sum(curved_weight_untold, 3);
  return curved > 0 && all > 0 ? std::max(of_pairs, all / weight) : of_pairs;
}

std::unique_ptr<Stiffened> stiffened_by_force(const Triplets& A, const Scene& scene) {
  if (scene.force.size() == 0) return nullptr;
  EntryList entries = turning_forces(scene);
  if (!entries.empty()) {
    const Dirichlet dirichlet(A, dofs_of(points_of(scene.nodes)));
    const auto is_held = [&](const Eigen::Triplet<Real, Index>& e) {
      return dirichlet.holds(e.row()) || dirichlet.holds(e.col());
    };
    entries.erase(std::remove_if(entries.begin(), entries.end(), is_held), entries.end());
  }
  Matrix of_pairs(A.n, A.n);
  if (scene.pairing) of_pairs = scene.pairing->stiffness(A.n);
  if (of_pairs.nonZeros() == 0 && entries.empty()) return nullptr;
  return std::make_unique<Stiffened>(A, std::move(of_pairs), sparse(A.n, A.n, entries));
}

Stiffened::Stiffened(const Triplets& A, Matrix of_pairs, Matrix of_obstacles)
    : view_(A),
      i_(A.i, A.i + A.size),
      j_(A.j, A.j + A.size),
      a_(A.a, A.a + A.size),
      of_pairs_(std::move(of_pairs)),
      of_obstacles_(std::move(of_obstacles)) {
  for (const Matrix* S : {&of_pairs_, &of_obstacles_})
    for (Index r = 0; r < S->rows(); ++r)
      for (Matrix::InnerIterator e(*S, r); e; ++e) {
        if (A.half && e.col() > r) continue;
        i_.push_back(r + A.base);
        j_.push_back(e.col() + A.base);
        a_.push_back(-e.value());
      }
}

Triplets Stiffened::view(std::size_t size) const {
  Triplets t = view_;
  t.size = size;
  t.i = i_.data();
  t.j = j_.data();
  t.a = a_.data();
  return t;
}

}  // namespace frictioncg
