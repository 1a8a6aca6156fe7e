#pragma once
#include "freefem.h"

#include "arguments.h"
#include "dirichlet.h"
#include "node_values.h"
#include "progress.h"

namespace frictioncg {

/// The named outputs that a script asked for; null where it did not.
struct Outputs {
  Stack stack;
  const Arguments& args;
  long* status = args.output<long>(stack, p_status);
  double* residual = args.output<double>(stack, p_residual);
  long* iterations = args.output<long>(stack, p_iterations);
  KN<double>* force = args.output<KN<double>>(stack, p_force);
  KN<double>* obstacle_force = args.output<KN<double>>(stack, p_obstacleforce);
  KN<long>* state = args.output<KN<long>>(stack, p_state);
  KN<double>* normals = args.output<KN<double>>(stack, p_normals);
  KN<double>* distance = args.output<KN<double>>(stack, p_distance);
  long* free = args.output<long>(stack, p_free);
  KNM<double>* history = args.output<KNM<double>>(stack, p_history);
  KN<double>* times = args.output<KN<double>>(stack, p_times);
};

/// The force of contact on the bodies, by components; zero off the contact nodes (ndof).
inline void write_force(const Scene& scene, const Vector& r, KN<double>* out) {
  const Vector force = scene.system->force_to_global(r);
  out->resize(scene.ndof());
  for (long i = 0; i < scene.ndof(); ++i) (*out)[i] = force[i];
}

/// r = F - Ax without what separated nodes have of it: no more than the residual, and no force.
/// What is more is the shear of a given limit, which acts without pressure, too.
inline Vector contact_forces(const Scene& scene, const Solution& s) {
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

/// The part of r that an obstacle bears, not another body.
inline Vector on_obstacle(const Scene& scene, Vector r) {
  const std::vector<Index>& first = scene.system->system()->first;
  for (Index k = 0; k < scene.system->nodes(); ++k)
    if (!scene.on_obstacle(k)) r.segment(first[k], first[k + 1] - first[k]).setZero();
  return r;
}

/// The state of the mesh node that starts at contact node k. A node in a corner, where there is no
/// friction, slides along what its closed normals leave, and sticks where they leave nothing.
inline NodeState state_in_corner(const Scene& scene, const std::vector<NodeState>& state, Index k) {
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

/// The mid-edges of a P2 slave that something faces, which carry no law, between their ends: by the
/// dofs of component c.
template <class Between>
void fill_slave_edges(const Scene& scene, Between between) {
  if (!scene.pairing) return;
  const Interface& faces = scene.pairing->between();
  for (const mortar::MidEdge& e : scene.pairing->edges())
    for (int c = 0; c < scene.d; ++c)
      between(faces.dof[e.node][c], faces.dof[e.a][c], faces.dof[e.b][c]);
}

/// The state at each dof of a contact node; zero elsewhere (ndof). Mid-edges of a P2 slave have
/// that of their freer end.
inline void write_state(const Scene& scene, const std::vector<NodeState>& state, KN<long>* out) {
  out->resize(scene.ndof());
  *out = 0L;
  for (Index k = 0; k < scene.system->nodes(); ++k) {
    if (!scene.starts_node(k)) continue;
    const long at_node = static_cast<long>(state_in_corner(scene, state, k));
    for (int c = 0; c < scene.d; ++c) (*out)[scene.contact_point(k).point.dof[c]] = at_node;
  }
  fill_slave_edges(scene, [out](Index middle, Index a, Index b) {
    const long at_a = (*out)[a], at_b = (*out)[b];
    (*out)[middle] = at_a > 0 && at_b > 0 ? std::min(at_a, at_b) : std::max(at_a, at_b);
  });
}

/// Makes unit vectors of the sums at the mid-edges of a P2 slave.
inline void normalize_slave_edges(const Scene& scene, KN<double>* out) {
  if (!scene.pairing) return;
  const Interface& faces = scene.pairing->between();
  for (const mortar::MidEdge& e : scene.pairing->edges()) {
    double length = 0;
    for (int c = 0; c < scene.d; ++c) length = std::hypot(length, (*out)[faces.dof[e.node][c]]);
    for (int c = 0; c < scene.d && length > 0; ++c) (*out)[faces.dof[e.node][c]] /= length;
  }
}

/// The outward normal of the laws at each contact node, by components; zero elsewhere (ndof). In a
/// corner, which slides freely along what its normals leave, the direction in which it presses.
inline void write_normals(const Scene& scene, const Vector& r, KN<double>* out) {
  const Vector force = scene.system->force_to_global(on_obstacle(scene, r));
  out->resize(scene.ndof());
  *out = 0.;
  for (Index k = 0; k < scene.system->nodes(); ++k) {
    if (!scene.starts_node(k)) continue;
    const ContactPoint& point = scene.contact_point(k).point;
    double pressed = 0;
    for (int c = 0; c < scene.d; ++c) pressed = std::hypot(pressed, force[point.dof[c]]);
    const bool corner = scene.system->node(k).shared && pressed > 0;
    for (int c = 0; c < scene.d; ++c)
      (*out)[point.dof[c]] = corner ? -force[point.dof[c]] / pressed : point.normal[c];
  }
  fill_slave_edges(
      scene, [out](Index middle, Index a, Index b) { (*out)[middle] = (*out)[a] + (*out)[b]; });
  normalize_slave_edges(scene, out);
}

/// The distance of the bodies at each dof of a contact node, and of a mid-edge of a P2 slave that
/// something faces; that of an obstacle is its gap; zero elsewhere (ndof).
inline void write_distance(const Scene& scene, const PointLaws& laws, KN<double>* out) {
  out->resize(scene.ndof());
  *out = 0.;
  const Vector gap = laws.gap - moved_along_normals(scene);
  for (Index k = 0; k < scene.system->nodes(); ++k) {
    const Index point = scene.system->node(k).point;
    for (int c = 0; c < scene.d; ++c)
      (*out)[scene.contact_point(k).point.dof[c]] =
          scene.on_obstacle(k) ? gap[point] : scene.pairing->distance(point);
  }
  for (const mortar::MidEdge& e : scene.pairing->edges())
    for (int c = 0; c < scene.d; ++c) (*out)[scene.pairing->between().dof[e.node][c]] = e.distance;
}

/// CPU seconds of the phases; `all` from the call's beginning.
inline void write_times(const Scene& scene, const Times& t, double all, KN<double>* out) {
  const double phases[] = {scene.copy_seconds, t.order,
                           t.factor,           t.condense,
                           t.contact,          t.back_substitution,
                           t.certificate,      scene.copy_seconds + all};
  out->resize(8);
  for (int k = 0; k < 8; ++k) (*out)[k] = phases[k];
}

/// Fills all but the times.
inline void write_outputs(const Scene& scene, const Solution& solution, const PointLaws& laws,
                          const Progress& progress, const Outputs& out) {
  if (out.status) *out.status = static_cast<long>(solution.status);
  if (out.residual) *out.residual = solution.certificate.residual;
  if (out.iterations) *out.iterations = solution.iterations;
  const Vector r = contact_forces(scene, solution);
  if (out.force) write_force(scene, r, out.force);
  if (out.obstacle_force) write_force(scene, on_obstacle(scene, r), out.obstacle_force);
  if (out.state) write_state(scene, solution.state, out.state);
  if (out.normals) write_normals(scene, r, out.normals);
  if (out.distance) write_distance(scene, laws, out.distance);
  if (out.free) *out.free = solution.undetermined.cols();
  if (out.history) progress.write_history(out.history);
}

}  // namespace frictioncg
