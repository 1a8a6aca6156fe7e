#include "outputs.h"

#include "node_values.h"
#include "report.h"

namespace frictioncg {

namespace {

/// The force of contact on the bodies, by components; zero off the contact nodes (ndof).
void write_force(const Scene& scene, const Vector& r, KN<double>* out) {
  write(scene.system->force_to_global(r).head(scene.ndof()), out);
}

/// The part of r that an obstacle bears, not another body.
Vector on_obstacle(const Scene& scene, Vector r) {
  const std::vector<Index>& first = scene.system->system()->first;
  for (Index k = 0; k < scene.system->nodes(); ++k)
    if (!scene.on_obstacle(k)) r.segment(first[k], first[k + 1] - first[k]).setZero();
  return r;
}

/// The state of the mesh node that starts at contact node k. A node in a corner, where there is no
/// friction, slides along what its closed normals leave, and sticks where they leave nothing.
NodeState state_in_corner(const Scene& scene, const std::vector<NodeState>& state, Index k) {
  if (!scene.system->node(k).shared) return state[k];
  int closed = 0;
  Index next = k;
  do {
    closed += state[next] != NodeState::separated;
    ++next;
  } while (next < scene.system->nodes() && !scene.starts_node(next));
  if (closed == 0) return NodeState::separated;
  return closed == scene.d ? NodeState::stick : NodeState::slip;
}

/// visit(middle, a, b, e): the dofs of each mid-edge e of a P2 slave that something faces, which
/// carries no law, and of its ends.
template <class Visit>
void for_each_slave_edge(const Scene& scene, const Visit& visit) {
  if (!scene.pairing) return;
  const NodeDofs& dof = scene.pairing->between().dof;
  for (const mortar::MidEdge& e : scene.pairing->faced().edges)
    visit(dof[e.node], dof[e.a], dof[e.b], e);
}

/// The state at each dof of a contact node; zero elsewhere (ndof). Mid-edges of a P2 slave have
/// that of their freer end.
std::vector<long> state_at_dofs(const Scene& scene, const std::vector<NodeState>& state) {
  std::vector<long> at(scene.ndof(), 0);
  for (Index k = 0; k < scene.system->nodes(); ++k) {
    if (!scene.starts_node(k)) continue;
    const long at_node = static_cast<long>(state_in_corner(scene, state, k));
    for (int c = 0; c < scene.d; ++c) at[scene.contact_point(k).point.dof[c]] = at_node;
  }
  for_each_slave_edge(scene, [&](const auto& middle, const auto& a, const auto& b, const auto&) {
    const long one = at[a[0]], other = at[b[0]];
    const long freer = one > 0 && other > 0 ? std::min(one, other) : std::max(one, other);
    for (int c = 0; c < scene.d; ++c) at[middle[c]] = freer;
  });
  return at;
}

/// The outward normal of the laws at each contact node, by components; zero elsewhere (ndof). In a
/// corner, which slides freely along what its normals leave, the direction in which it presses.
Vector normals_at_dofs(const Scene& scene, const Vector& r) {
  const Vector force = scene.system->force_to_global(on_obstacle(scene, r));
  Vector n = Vector::Zero(scene.ndof());
  for (Index k = 0; k < scene.system->nodes(); ++k) {
    if (!scene.starts_node(k)) continue;
    const ContactPoint& point = scene.contact_point(k).point;
    double pressed = 0;
    for (int c = 0; c < scene.d; ++c) pressed = std::hypot(pressed, force[point.dof[c]]);
    const bool corner = scene.system->node(k).shared && pressed > 0;
    for (int c = 0; c < scene.d; ++c)
      n[point.dof[c]] = corner ? -force[point.dof[c]] / pressed : point.normal[c];
  }
  for_each_slave_edge(scene, [&](const auto& middle, const auto& a, const auto& b, const auto&) {
    Vec3 mean = Vec3::Zero();
    for (int c = 0; c < scene.d; ++c) mean[c] = n[a[c]] + n[b[c]];
    mean.normalize();
    for (int c = 0; c < scene.d; ++c) n[middle[c]] = mean[c];
  });
  return n;
}

/// The distance of the bodies at each dof of a contact node, and of a mid-edge of a P2 slave that
/// something faces; that of an obstacle is its gap; zero elsewhere (ndof).
Vector distance_at_dofs(const Scene& scene, const PointLaws& laws) {
  Vector distance = Vector::Zero(scene.ndof());
  const Vector gap = laws.gap - moved_along_normals(scene);
  for (Index k = 0; k < scene.system->nodes(); ++k) {
    const Index point = scene.system->node(k).point;
    for (int c = 0; c < scene.d; ++c)
      distance[scene.contact_point(k).point.dof[c]] =
          scene.on_obstacle(k) ? gap[point] : scene.pairing->faced().distance_at(point);
  }
  for_each_slave_edge(scene, [&](const auto& middle, const auto&, const auto&, const auto& e) {
    for (int c = 0; c < scene.d; ++c) distance[middle[c]] = e.distance;
  });
  return distance;
}

}  // namespace

Vector contact_forces(const Scene& scene, const Solution& s) {
  constexpr Real rounding = 1 + 1e-9;
  const System& system = *scene.system->system();
  const Real error = rounding * s.certificate.residual * s.certificate.scale;
  Vector r = s.certificate.r;
  for (Index k = 0; k < system.nodes(); ++k)
    for (Index i = system.first[k]; i < system.first[k + 1]; ++i)
      if (s.state[k] == NodeState::separated &&
          std::abs(r[i]) <= error * std::sqrt(system.weight[i]))
        r[i] = 0;
  return r;
}

void write_outputs(const Scene& scene, const Solution& solution, const PointLaws& laws,
                   const Progress& progress, const Outputs& out) {
  if (out.status) *out.status = static_cast<long>(solution.status);
  if (out.residual) *out.residual = solution.certificate.residual;
  if (out.iterations) *out.iterations = solution.iterations;
  const Vector r = contact_forces(scene, solution);
  if (out.force) write_force(scene, r, out.force);
  if (out.obstacle_force) write_force(scene, on_obstacle(scene, r), out.obstacle_force);
  if (out.state) write(state_at_dofs(scene, solution.state), out.state);
  if (out.normals) write(normals_at_dofs(scene, r), out.normals);
  if (out.distance) write(distance_at_dofs(scene, laws), out.distance);
  if (out.free) *out.free = solution.undetermined.cols();
  progress.write_history(out.history);
}

}  // namespace frictioncg
