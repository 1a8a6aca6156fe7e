#pragma once
#include "freefem.h"

#include "block_order.h"
#include "newton_step.h"
#include "node_values.h"
#include "outputs.h"
#include "motions.h"
#include "obstacles.h"
#include "one_value.h"
#include "plan_report.h"
#include "report.h"
#include "site.h"
#include "weight.h"

namespace frictioncg {

/// What a call says beside geometry and laws. Every expression of the script is evaluated before
/// anything is solved or written: one of them may throw, or change what the call works on.
struct Call {
  const Arguments& args;
  Settings settings;
  long verb;
  Vector b, u_old, u_init;  ///< u_old and u_init empty where they are not given
  Motions motions;          ///< of obstacles that move

  Call(Stack stack, const Arguments& arguments, const Expression load)
      : args(arguments),
        settings(read_settings(stack, arguments)),
        verb(read_verb(stack, arguments)),
        b(evaluated("b", [&] { return copy_of(GetAny<KN_<double>>((*load)(stack))); })),
        u_old(vector_of(stack, args, p_uold)),
        u_init(vector_of(stack, args, args.start())),
        motions(stack, args) {}
};

/// The script's matrix as it is now.
inline Triplets read_matrix(Stack stack, const Expression A, const Scene& scene) {
  return evaluated(
      "A", [&] { return triplets(GetAny<Matrice_Creuse<double>*>((*A)(stack)), scene.dofs); });
}

/// Finds the contact nodes of two bodies, beside those on an obstacle. A shows what Dirichlet
/// conditions hold of them.
inline void face_bodies(Stack stack, const Arguments& args, const Expression A, Scene& scene) {
  mortar::Options& options = scene.facing;
  options.maxgap = args.value(stack, p_maxgap, options.maxgap);
  options.smooth = args.value(stack, p_smooth, options.smooth);
  if (args.has(p_normal)) options.normals = slave_normals(stack, args, scene);
  if (args.has(p_weight)) options.weight = slave_weights(stack, args, scene);
  const Triplets matrix = read_matrix(stack, A, scene);
  refuse_exchanged_blocks(scene, matrix);
  if (args.has(p_forceold)) {
    const Vector force = vector_of(stack, args, p_forceold);
    check_vector(force, parameters[p_forceold].name, scene.dofs);
    options.force = scene.pairing->at_nodes(force, scene.d);
  }
  Vector u_old;  // where the increment of a geometry that moves began
  if (scene.at && args.has(p_uold)) {
    u_old = vector_of(stack, args, p_uold);
    check_vector(u_old, "uold", scene.dofs);
  }
  constexpr Parameter chosen[] = {p_maxgap, p_smooth, p_normal, p_weight};
  scene.face(matrix, options, u_old, !args.has_any(chosen));
}

/// A may be definite where it is not less the stiffness of contact forces.
inline void report_plain(long verb) {
  if (verb > 1)
    line() << "A less the stiffness of forceold has no answer here, as where it is indefinite: A "
              "stands"
           << std::endl;
}

/// pose(A), less the stiffness of forceold where that leaves stiffnesses > 0.
template <class Pose>
void assemble(const Triplets& A, Scene& scene, long verb, const Pose& pose) {
  if (!scene.facing.force.empty()) {
    scene.stiffened = std::make_unique<Stiffened>(A, scene.pairing->stiffness(A.n, scene.d));
    try {
      return pose(scene.stiffened->less());
    } catch (const IllegalInput&) {
      report_plain(verb);
      scene.stiffened.reset();
    }
  }
  with_components_in_words(scene, [&] { pose(A); });
}

/// The laws that the arguments name at the contact points, which get their tangents: a node has
/// tangential laws where `everywhere` or its own mu or limit asks for them.
inline PointLaws read_point_laws(Stack stack, const Arguments& args, bool everywhere, Scene& scene,
                                 PointLaws begun) {
  PointLaws laws = read_laws(stack, args, scene, std::move(begun));
  if (args.has(p_mu2)) set_orthotropy(stack, args, laws.mu, scene);
  if (laws.law == Law::frictionless) return laws;
  scene.tangents |= everywhere;  // nothing may face the slave yet
  for (std::size_t k = 0; k < scene.nodes.size(); ++k)
    scene.tangents |= scene.nodes[k].point.friction =
        everywhere || laws.rubs(static_cast<Index>(k));
  return laws;
}

/// Where the geometry of a call is; null where it is that of the mesh.
inline Stage read_stage(Stack stack, const Arguments& args) {
  if (!args.has(p_at)) return {};
  const auto read = [&](Parameter p) {
    return args.has(p) ? std::make_shared<const Vector>(vector_of(stack, args, p)) : nullptr;
  };
  return {read(p_at), read(p_uold)};
}

/// The points on an obstacle with the weights and normals of the call.
inline void read_obstacle_points(Stack stack, const Arguments& args, bool lasts, Scene& scene) {
  set_weights(stack, args, scene);
  scene.given_weight = args.has(p_weight);
  if (lasts) scene.on_mesh = scene.nodes;
  set_normals(stack, args, scene);
}

/// Of the points on obstacles alone.
inline void follow_free_motions(Stack stack, const Expression A, Scene& scene) {
  if (!has_curved_obstacle(scene)) return;
  const Triplets matrix = read_matrix(stack, A, scene);
  const std::vector<NodePlace> places = scene.places();
  std::vector<ContactPoint> points;
  Index bodies = 0;
  for (const BoundaryNode& p : scene.nodes) points.push_back(p.point);
  for (const NodePlace& p : places) bodies = std::max(bodies, p.body + 1);
  follow_free_motions(
      scene, places, extent_of(places), bodies, any_begun(scene.nodes),
      [&](FreedomOfBodies& freedom) { freedom.add(matrix, Dirichlet(matrix, points), places); });
}

/// Reads the problem: geometry, laws, and the matrix in local frames. lasts: for further calls,
/// which may name other laws, and other matrices.
inline std::shared_ptr<Scene> read_scene(Stack stack, const Arguments& args, const Expression A,
                                         const Site& site, bool lasts, PointLaws& laws) {
  const Stage stage = read_stage(stack, args);
  std::shared_ptr<Scene> scene = site.scene(stack, args.obstacle(stack), stage);
  read_obstacle_points(stack, args, lasts, *scene);
  if (!scene->pairing) scene->moving = read_obstacles(stack, args, *scene);
  if (scene->nodes.empty() && !scene->averted.empty()) refuse_inward(*scene);
  follow_free_motions(stack, A, *scene);
  if (scene->pairing) face_bodies(stack, args, A, *scene);
  laws = read_point_laws(stack, args, lasts, *scene, begun_laws(stack, args));
  const Triplets matrix = read_matrix(stack, A, *scene);
  assemble(matrix, *scene, read_verb(stack, args), [&](const Triplets& M) { scene->assemble(M); });
  scene->unnamed_radius = unnamed_radius(args, *scene, matrix);
  if (!scene->tangents) laws.law = Law::frictionless;
  return scene;
}

/// Sizes, and finite values.
inline void check_vectors(const Call& call, const DofCount& dofs) {
  check_vector(call.b, "b", dofs);
  if (call.args.has(p_uold)) check_vector(call.u_old, "uold", dofs);
  if (call.args.has(call.args.start()))
    check_vector(call.u_init, parameters[call.args.start()].name, dofs);
}

/// Of a call on a contactproblem.
inline void refuse_motions(const Arguments& args, const Scene& scene) {
  for (Parameter p : of_moving_obstacle)
    if (!scene.moving && args.has(p))
      throw IllegalInput(std::string(parameters[p].name) +
                         " is of an obstacle that moves, and C was made with none; name pivot or "
                         "motionfree in contactProblem(...)");
}

/// The vectors of a call by all dofs: those of the script, then those of obstacles that move.
struct Vectors {
  Vector b, u_old, u_init;  ///< u_old and u_init empty where nothing gives them

  Vectors(const Call& call, const Scene& scene)
      : b(scene.stiffened ? scene.stiffened->load(call.b, *scene.at) : call.b),
        u_old(call.u_old),
        u_init(call.u_init) {
    if (!scene.moving) return;
    Motions motions = call.motions;
    motions.complete(*scene.moving, scene.d);
    b = joined(b, motions.load);
    if (u_old.size() == 0 && !motions.before.isZero(0)) u_old = Vector::Zero(scene.ndof());
    if (u_old.size() > 0) u_old = joined(u_old, motions.before);
    if (u_init.size() > 0) u_init = joined(u_init, motions.guess);
  }
};

/// These vectors, and the laws, as an increment in local dofs.
inline LocalIncrement increment(const Call& call, const Vectors& vectors, const Scene& scene,
                                PointLaws laws) {
  if (scene.system->nodes() == 0) laws.law = Law::frictionless;  // supports hold every normal
  const LocalLoad load = scene.system->load_from(vectors.b, scene.slip_from(vectors.u_old));
  LocalIncrement now = scene.increment(load, laws);
  report_leftover(check_data(scene, call.b, now.u0), call.verb);
  check_one_value(scene, call.b, call.verb);
  return now;
}

/// With `at` the load of a step is what the last one has left: nothing, where bodies have parted,
/// of which rounding is all that can be asked.
inline void accept_rounding(Solution& s) {
  const Certificate& c = s.certificate;
  if (s.status == Status::stagnated && c.residual <= 10 * c.attainable)
    s.status = Status::converged;
}

/// The field of one increment, on a posed scene.
inline KN_<double> solve(Stack stack, const Call& call, Scene& scene, const PointLaws& laws) {
  const double start = cpu_seconds();
  const Outputs out{stack, call.args};
  check_vectors(call, scene.dofs);
  const Vectors vectors(call, scene);
  const LocalIncrement now = increment(call, vectors, scene, laws);
  const ContactProblem problem{scene.system->system(), now.increment};
  if (call.verb > 0) {
    report_plan(call.args, scene, problem, call.settings, call.verb);
    warn_of_averages(scene);
    report_averted(scene);
    warn_of_passed(stack, call.args, scene);
    report_large_friction(largest_friction(problem));
    note_weight(scene);
    note_contrast(*scene.system->system());
  }
  Progress progress(problem, call.verb, out.history);
  Vector x0;
  if (vectors.u_init.size() > 0)
    x0 = scene.system->to_local(vectors.u_old.size() == 0 ? vectors.u_init
                                                          : Vector(vectors.u_init - vectors.u_old));
  Solution solution = scene.solver->solve(now.increment, call.settings, x0,
                                          call.verb > 0 || out.history ? &progress : nullptr);
  if (scene.at) accept_rounding(solution);
  if (solution.status != Status::converged && scene.stiffened) {
    report_plain(call.verb);
    scene.assemble_plain();
    return solve(stack, call, scene, laws);
  }
  if (scene.stiffened)
    solution = newton_step(std::move(solution), now.u0, call.settings, scene, vectors.b,
                           vectors.u_old, laws);
  const Vector moved = scene.system->to_global(solution.x, now.u0),
               field = moved.head(scene.ndof());
  const std::string turned = runaway(scene, solution, field);
  if (!turned.empty()) solution.status = Status::runaway;
  if (call.verb > 0) {
    report_memory(scene.solver->memory_needed(), call.settings);
    report_end(solution);
    report_motions(scene, solution, turned, call.verb);
  }
  if (call.verb > 2) report_phases(scene, solution);
  if (solution.status != Status::converged && !out.status)
    refuse_unconverged(
        solution, call.settings,
        solution.unheld_motion.size() > 0 ? describe(scene, solution.unheld_motion) : turned);
  write_outputs(scene, solution, laws, progress, out);
  if (scene.moving) write_motions(scene, solution, moved, call.motions);
  if (call.verb > 0) warn_of_large_displacements(scene, field);
  if (call.verb > 0 && scene.moving) warn_of_turns(scene, moved);
  KN<double>* u = Add2StackOfPtr2Free(stack, new KN<double>(scene.ndof()));
  for (long i = 0; i < scene.ndof(); ++i) (*u)[i] = field[i];
  if (out.times) write_times(scene, solution.times, cpu_seconds() - start, out.times);
  scene.copy_seconds = 0;  // further increments do not copy
  return *u;
}

}  // namespace frictioncg
