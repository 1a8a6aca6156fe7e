#pragma once
#include "freefem.h"

#include "arguments.h"
#include "dirichlet.h"
#include "progress.h"

namespace frictioncg {

/// The named outputs that a script asked for; null where it did not.
struct Outputs {
  long* status;
  double* residual;
  long* iterations;
  KN<double>* force;
  KN<long>* state;
  KN<double>* normals;
  KNM<double>* history;
  KN<double>* times;

  Outputs(Stack stack, const Arguments& args)
      : status(args.output<long>(stack, p_status)),
        residual(args.output<double>(stack, p_residual)),
        iterations(args.output<long>(stack, p_iterations)),
        force(args.output<KN<double>>(stack, p_force)),
        state(args.output<KN<long>>(stack, p_state)),
        normals(args.output<KN<double>>(stack, p_normals)),
        history(args.output<KNM<double>>(stack, p_history)),
        times(args.output<KN<double>>(stack, p_times)) {}
};

/// The force of the obstacle on the body, by components; zero off the contact nodes (ndof).
inline void write_force(const Scene& scene, const Vector& r, KN<double>* out) {
  const Vector force = scene.system->force_to_global(r);
  out->resize(scene.ndof);
  for (long i = 0; i < scene.ndof; ++i) (*out)[i] = force[i];
}

/// At each dof of a contact node, the value of its node; zero elsewhere (ndof).
template <class T, class Value>
void write_at_nodes(const Scene& scene, KN<T>* out, Value value) {
  out->resize(scene.ndof);
  *out = T(0);
  for (Index k = 0; k < scene.system->nodes(); ++k) {
    const ContactPoint& point = scene.nodes[scene.system->node(k).point].point;
    for (int c = 0; c < scene.d; ++c) (*out)[point.dof[c]] = value(k, point, c);
  }
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
inline void write_outputs(const Scene& scene, const Solution& solution, const Progress& progress,
                          const Outputs& out) {
  if (out.status) *out.status = static_cast<long>(solution.status);
  if (out.residual) *out.residual = solution.certificate.residual;
  if (out.iterations) *out.iterations = solution.iterations;
  if (out.force) write_force(scene, solution.certificate.r, out.force);
  if (out.state)
    write_at_nodes(scene, out.state, [&](Index k, const ContactPoint&, int) {
      return static_cast<long>(solution.state[k]);
    });
  // the outward normal of the laws
  if (out.normals)
    write_at_nodes(scene, out.normals,
                   [](Index, const ContactPoint& point, int c) { return point.normal[c]; });
  if (out.history) progress.write_history(out.history);
}

}  // namespace frictioncg
