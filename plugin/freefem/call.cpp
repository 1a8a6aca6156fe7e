#include "call.h"

#include "../core/clock.h"
#include "../core/gradient/anderson.h"
#include "../core/statics/floating.h"
#include "../core/statics/undetermined.h"
#include "../core/threads.h"
#include "checks.h"
#include "motions.h"
#include "node_values.h"
#include "outputs.h"
#include "report.h"

namespace frictioncg {

namespace {

/// Whether contact points are at the same nodes.
bool same_points(const std::vector<BoundaryNode>& one, const std::vector<BoundaryNode>& other) {
  return std::equal(
      one.begin(), one.end(), other.begin(), other.end(),
      [](const BoundaryNode& p, const BoundaryNode& q) { return p.point.dof == q.point.dof; });
}

/// Finds the contact nodes of two bodies, beside those on an obstacle. A shows what Dirichlet
/// conditions hold of them.
void face_bodies(Stack stack, const Arguments& args, const Expression A, Scene& scene) {
  mortar::Options& options = scene.facing;
  options.maxgap = args.value(stack, p_maxgap, options.maxgap);
  options.smooth = args.value(stack, p_smooth, options.smooth);
  if (args.has(p_normal)) options.normals = slave_normals(stack, args, scene);
  options.weight = slave_weights(stack, args, scene);
  if (scene.force.size() > 0) options.force = scene.pairing->at_nodes(scene.force);
  Vector u_old;  // where the increment of a geometry that moves began
  if (scene.at) u_old = args.vector(stack, p_uold, scene.dofs);
  const Triplets matrix = matrix_of(stack, A, scene.dofs);  // once no expression may change A
  refuse_exchanged_blocks(scene, matrix);
  const bool again = !args.has_any({p_maxgap, p_smooth, p_normal, p_weight});
  const Stopwatch watch(scene.copy_seconds);
  const std::vector<BoundaryNode> of_obstacle = std::move(scene.nodes);
  scene.nodes = scene.pairing->face(matrix, options, u_old, of_obstacle, scene.places, again);
  scene.nodes.insert(scene.nodes.end(), of_obstacle.begin(), of_obstacle.end());
  scene.beside_pairs = of_obstacle.size();
}

/// The points on an obstacle with the weights and normals of the call.
void read_obstacle_points(Stack stack, const Arguments& args, bool lasts, Scene& scene) {
  set_weights(stack, args, scene);
  scene.given_weight = args.has(p_weight);
  if (lasts) scene.on_mesh = scene.nodes;
  set_normals(stack, args, scene);
}

/// The geometry of C at the displacement of the call, which names anew what C was given at places.
std::shared_ptr<Scene> moved(Stack stack, const Arguments& args, const Scene& before) {
  const std::shared_ptr<Scene> scene =
      scene_at(read_stage(stack, args), before.spaces, before.sides);
  const auto require = [&](Parameter p, bool given) {
    if (given && !args.has(p))
      refuse("at moves the nodes of C, and ", name_of(p),
             ", which C was made with, is not given; give both");
  };
  require(scene->pairing ? p_obstaclenormal : p_normal, before.given_normals);
  require(p_normal, !before.facing.normals.empty());
  require(p_weight, before.given_weight);
  scene->tangents = before.tangents;
  scene->unnamed_radius = before.unnamed_radius;
  scene->facing = before.facing;
  scene->facing.force.clear();  // forceold belongs to the call that names it
  read_obstacle_points(stack, args, true, *scene);
  scene->moving = before.moving;
  if (scene->moving) {
    find_obstacles(*scene, *scene->moving);
    set_arms(*scene, *scene->moving);
  }
  return scene;
}

/// The same geometry, with the points on an obstacle with the normals and weights of the call, or
/// as they were.
std::shared_ptr<Scene> unmoved(Stack stack, const Arguments& args, const Scene& before) {
  const auto scene = std::make_shared<Scene>();
  static_cast<Geometry&>(*scene) = before;
  const Parameter normal = scene->pairing ? p_obstaclenormal : p_normal;
  if (!args.has(normal) && (!args.has(p_weight) || scene->on_mesh.empty())) {
    std::vector<BoundaryNode>& nodes = scene->nodes;
    nodes.erase(nodes.begin(), nodes.begin() + static_cast<long>(scene->paired()));
    return scene;
  }
  if (!args.has(normal) && scene->given_normals)
    refuse("weight is given with the new matrix, and ", name_of(normal),
           ", which C was made with, is not; give both");
  scene->nodes = scene->on_mesh;
  scene->averted.clear();
  set_weights(stack, args, *scene);
  set_normals(stack, args, *scene);
  return scene;
}

/// What A and the last force make of points on obstacles, and the contact nodes of pairs.
void face(Stack stack, const Arguments& args, const Expression A, Scene& scene) {
  if (scene.nodes.empty() && !scene.averted.empty()) refuse_inward(scene);
  if (has_curved_obstacle(scene)) {
    const std::vector<NodePlace> places = scene.places();
    follow_free_motions(matrix_of(stack, A, scene.dofs), places, extent_of(places), scene);
  }
  if (args.has(p_forceold)) scene.force = args.vector(stack, p_forceold, scene.dofs);
  if (scene.pairing) face_bodies(stack, args, A, scene);
}

/// Points that have been found anew take from those before what no such call names.
void take_over(const Scene& before, Scene& scene) {
  const bool same = same_points(before.nodes, scene.nodes);
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    ContactPoint& p = scene.nodes[k].point;
    p.friction = scene.tangents;
    if (!same) continue;
    p.direction = before.nodes[k].point.direction;
    p.mu_ratio = before.nodes[k].point.mu_ratio;
  }
  const auto orthotropic = [](const BoundaryNode& n) { return n.point.mu_ratio != 1; };
  if (!same && std::any_of(before.nodes.begin(), before.nodes.end(), orthotropic))
    throw IllegalInput(
        "other nodes than those of C are to touch, and its mu2 and direction hold for the latter; "
        "make C anew, with contactProblem(...)");
}

/// Whether the call names all that bounds friction in these laws.
bool names_friction(const Arguments& args, const PointLaws& laws) {
  if (laws.law == Law::frictionless || args.has(p_slidinglimit)) return true;
  if (laws.law == Law::tresca) return args.has_any(frictions);
  const auto named = [&](Parameter p, const Vector& v) {
    return v.size() == 0 || v.isZero(0) || args.has(p);
  };
  return named(p_mu, laws.mu) && named(p_cohesion, laws.cohesion) && named(p_shearmax, laws.cap);
}

/// The laws of C at the points of its scene as it is posed anew: where these are others, the call
/// has to name what C had.
PointLaws laws_at(const Arguments& args, const Scene& before, const Scene& scene, PointLaws laws) {
  const Index paired = static_cast<Index>(before.paired());
  const Vector moved = moved_along_normals(before);
  const bool of_meshes = scene.pairing && !laws.given_gap;
  Vector gap = laws.gap - moved;  // what is left where the geometry is
  const Vector rest = gap.tail(gap.size() - paired);
  const Parameter gap_of_rest = scene.pairing ? p_obstaclegap : p_gap;
  const bool has_gap = (args.has(p_gap) || of_meshes || gap.head(paired).isZero(0)) &&
                       (args.has(gap_of_rest) || rest.isZero(0));
  if (args.has(p_at) && !has_gap)
    throw IllegalInput(
        "at moves the nodes of C, which has a gap at them; name it in this call, too");
  if (same_points(before.nodes, scene.nodes)) {
    if (of_meshes) gap.head(paired) = scene.pairing->gap();
    laws.gap = gap + moved_along_normals(scene);
    return laws;
  }
  const bool measured = of_meshes || paired == 0;  // for new points a given 0 is no answer
  if (!has_gap || !(measured || args.has(p_gap)) || !names_friction(args, laws))
    throw IllegalInput(
        "other nodes than those of C are to touch, by the normal or by the supports of the new "
        "matrix, and C has gap and friction at the latter alone; name them in this call, too");
  const bool none = laws.law == Law::coulomb && laws.mu.isZero(0);  // as it is where nodes are new
  for (Vector* v : {&laws.gap, &laws.mu, &laws.g, &laws.cohesion, &laws.cap}) v->resize(0);
  if (none) laws.mu = Vector::Zero(static_cast<Index>(scene.nodes.size()));
  return laws;
}

/// Reads A once no expression may change it, and poses A, less the stiffness of forceold where that
/// leaves stiffnesses > 0. before, alone: as Scene::assemble's.
Triplets assemble(Stack stack, const Arguments& args, const Expression A, Scene& scene,
                  Scene* before = nullptr, bool alone = false) {
  const long verb = read_verb(stack, args);
  const Threads of_call(read_threads(stack, args));
  const Triplets matrix = matrix_of(stack, A, scene.dofs);
  scene.stiffened = stiffened_by_force(matrix, scene);
  if (scene.stiffened) {
    try {
      scene.assemble(scene.stiffened->less(), before, alone);
      return matrix;
    } catch (const IllegalInput&) {
      report_plain(verb);
      scene.stiffened.reset();
    }
  }
  with_components_in_words(scene, [&] { scene.assemble(matrix, before, alone); });
  return matrix;
}

/// (of the script, of the obstacles)
Vector joined(const Vector& of_script, const Vector& of_obstacles) {
  Vector all(of_script.size() + of_obstacles.size());
  all << of_script, of_obstacles;
  return all;
}

/// newton_step of call.h in one process. b, u_old: by all dofs; u0: where the increment of s
/// starts. A gap that is given stays as it is.
Solution newton_step(Solution s, const Vector& u0, const Settings& settings, const Scene& scene,
                     const Vector& b, const Vector& u_old, const PointLaws& laws) {
  if (scene.system->nodes() == 0) return s;
  const Pairing& pairing = *scene.pairing;
  const Vector slip_from = scene.slip_from(u_old);
  const auto trace = [&](const Solution& of) {
    return pairing.at_nodes(scene.system->to_global(of.x, u0));
  };
  const auto pass = [&](const AtNodes& v, const Vector& x0) {
    const mortar::Change change = pairing.change(v);
    PointLaws of_pass = laws;
    if (!laws.given_gap) of_pass.gap.head(change.gap.size()) += change.gap;
    const Vector rest = b + pairing.on_free_dofs(change.force, b.size()) -
                        scene.stiffened->force_of_pairs(pairing.on_free_dofs(v, b.size()));
    const LocalLoad load = scene.system->load_from(rest, slip_from, true);
    return scene.solver->solve(scene.increment(load, of_pass).increment, settings, x0);
  };
  return newton_step(std::move(s), pairing.at_nodes(*scene.at), trace, pass);
}

}  // namespace

void report_plain(long verb) {
  if (verb > 1)
    line() << "A less the stiffness of forceold has no answer here, as where it is indefinite: A "
              "stands"
           << std::endl;
}

PointLaws read_point_laws(Stack stack, const Arguments& args, bool everywhere, Scene& scene,
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

Stage read_stage(Stack stack, const Arguments& args) {
  if (!args.has(p_at)) return {};
  const auto read = [&](Parameter p) {
    return args.has(p) ? std::make_shared<const Vector>(args.vector(stack, p)) : nullptr;
  };
  return {read(p_at), read(p_uold)};
}

std::shared_ptr<Scene> read_scene(Stack stack, const Arguments& args, const Expression A,
                                  const Site& site, bool lasts, PointLaws& laws) {
  const Stage stage = read_stage(stack, args);
  const std::vector<long> obstacle = args.obstacle(stack);
  if (site.is_on_part(stack))
    throw IllegalInput(
        "Vh lies on one process's part of a distributed mesh, and its matrix would be taken for "
        "the whole problem; load frictionCG-mpi, and give domain=C, which createMat(Th, C, Pk) "
        "makes");
  const Sides sides{site.labels(stack), site.masters(stack), obstacle};
  // the spaces last: what an expression does may make them anew
  const std::shared_ptr<Scene> scene = scene_at(stage, site.spaces(stack), sides);
  read_obstacle_points(stack, args, lasts, *scene);
  if (!scene->pairing) scene->moving = read_obstacles(stack, args, *scene);
  face(stack, args, A, *scene);
  laws = read_point_laws(stack, args, lasts, *scene, begun_laws(stack, args));
  scene->unnamed_radius = unnamed_radius(args, *scene, assemble(stack, args, A, *scene));
  if (!scene->tangents) laws.law = Law::frictionless;
  return scene;
}

void check_vectors(const Call& call, const DofCount& dofs) {
  check_vector(call.b, "b", dofs);
  if (call.args.has(p_uold)) check_vector(call.u_old, "uold", dofs);
  if (call.args.has(call.args.start())) check_vector(call.u_init, name_of(call.args.start()), dofs);
}

Vectors::Vectors(const Call& call, const Scene& scene)
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

LocalIncrement increment(const Vectors& vectors, const Scene& scene, PointLaws laws) {
  if (scene.system->nodes() == 0) laws.law = Law::frictionless;  // supports hold every normal
  LocalIncrement now = scene.increment(
      scene.system->load_from(vectors.b, scene.slip_from(vectors.u_old), scene.at != nullptr),
      laws);
  if (laws.law != Law::frictionless) return now;
  const System& system = *scene.system->system();
  const Real told = told_by_mesh(scene, scene.pairing ? scene.pairing->told() : 0, system);
  if (told > 0)
    now.left_out =
        leave_out_uncertain_work(system, floating_motions(system), told, now.increment.F);
  return now;
}

bool passes_by_rounding(const Solution& s, Real contrast, const Arguments& args, bool at) {
  constexpr Real little = 1e-6;  // beyond it a field is too far from the laws to pass unasked
  if (!(contrast < felt_contrast) || !may_be_rounding(s.certificate)) return false;
  return at || (!args.has(p_tol) && s.certificate.residual <= little);
}

Vector solve(Stack stack, const Call& call, Scene& scene, const PointLaws& laws) {
  const double start = cpu_seconds();
  const Outputs out{stack, call.args};
  Settings asked = call.settings;
  asked.buckles = !scene.at;
  check_vectors(call, scene.dofs);
  Vectors vectors(call, scene);
  LocalIncrement now = increment(vectors, scene, laws);
  report_leftover(check_data(scene, call.b, now.u0), call.verb);
  report_left_out(now.left_out, call.verb);
  check_one_value(scene, call.b, call.verb);
  check_load_for_data(scene, call.b, call.verb);
  ContactProblem problem{scene.system->system(), now.increment};
  if (call.verb > 0) report_plan(stack, call.args, scene, problem, call.settings, call.verb);
  Progress progress(problem, call.verb, out.history);
  const auto answer = [&](const Settings& settings) {
    Vector x0;
    if (vectors.u_init.size() > 0)
      x0 = scene.system->to_local(
          vectors.u_old.size() == 0 ? vectors.u_init : Vector(vectors.u_init - vectors.u_old));
    Solution s = scene.solver->solve(now.increment, settings, x0,
                                     call.verb > 0 || out.history ? &progress : nullptr);
    if (s.status == Status::stagnated &&
        passes_by_rounding(s, contrast(*scene.system->system()), call.args, scene.at != nullptr))
      s.status = Status::converged;
    return s;
  };
  Solution solution = answer(asked);
  const Settings rest = what_remains(problem, asked, solution);
  if (solution.status != Status::converged && scene.stiffened && rest.nbiter > 0) {
    report_plain(call.verb);
    {
      const std::unique_ptr<Stiffened> last = std::move(scene.stiffened);
      scene.assemble(last->plain());
    }
    vectors = Vectors(call, scene);
    now = increment(vectors, scene, laws);
    problem = {scene.system->system(), now.increment};
    solution = after(solution, answer(rest));
  }
  if (scene.pairing && scene.stiffened && solution.status == Status::converged)
    solution =
        newton_step(std::move(solution), now.u0, asked, scene, vectors.b, vectors.u_old, laws);
  const Vector moved = scene.system->to_global(solution.x, now.u0),
               field = moved.head(scene.ndof());
  const std::string turned = runaway(scene, problem, solution, field);
  if (!turned.empty()) solution.status = Status::runaway;
  const std::string blamed = turned.empty() ? blamed_motion(scene, solution) : turned;
  if (call.verb > 0) {
    report_memory(scene.solver->memory_needed(), call.settings);
    report_end(solution, blamed);
    report_held_friction(scene, problem, solution, now.u0, vectors.u_old);
    report_corners(scene, problem, solution);
    report_undetermined(scene, solution, call.verb);
  }
  if (call.verb > 2) report_phases(scene, solution);
  if (solution.status != Status::converged && !out.status)
    refuse_unconverged(solution, call.settings, blamed);
  write_outputs(scene, solution, laws, progress, out);
  if (scene.moving) write_motions(scene, solution, moved, call.motions);
  if (call.verb > 0) {
    warn_of_large_displacements(scene, field);
    warn_of_far_slips(scene, solution, moved);
    if (scene.moving) warn_of_turns(scene, moved);
  }
  const Times& t = solution.times;
  Vector seconds(8);
  seconds << scene.copy_seconds, t.order, t.factor, t.condense, t.contact, t.back_substitution,
      t.certificate, scene.copy_seconds + cpu_seconds() - start;
  write(seconds, out.times);
  scene.copy_seconds = 0;  // further increments do not copy
  return field;
}

Solution newton_step(Solution s, const AtNodes& U,
                     const std::function<AtNodes(const Solution&)>& trace,
                     const std::function<Solution(const AtNodes&, const Vector&)>& pass) {
  constexpr int passes = 5;
  constexpr Real precise = 1e-3;      // over the step: the next one is what it is squared
  constexpr Real negligible = 1e-10;  // over the displacement
  constexpr Real reach = 10;          // of a pass, over the step: slopes at U say nothing there
  constexpr Real contraction = 0.6;   // over the step: beyond, slopes at U say too little
  const auto stacked = [](const AtNodes& u) {
    return Vector(Eigen::Map<const Vector>(u.front().data(), 3 * static_cast<Index>(u.size())));
  };
  const Vector at = stacked(U);
  Vector u = stacked(trace(s));
  Real last = (u - at).lpNorm<Eigen::Infinity>();
  const Real enough = std::max(precise * last, negligible * u.lpNorm<Eigen::Infinity>());
  const Real far = contraction * last, longest = reach * last;
  Anderson anderson;
  u = anderson.next(at, u);
  AtNodes v(U.size());
  for (int k = 0; k < passes && last > enough; ++k) {
    if (!((u - at).lpNorm<Eigen::Infinity>() <= longest)) break;
    Eigen::Map<Vector>(v.front().data(), u.size()) = u - at;
    Solution next = pass(v, s.x);
    s.iterations += next.iterations;
    if (next.status != Status::converged) break;
    const Vector now = stacked(trace(next));
    const Real change = (now - u).lpNorm<Eigen::Infinity>();
    if (change <= std::min(far, last)) {  // what others tell serves the next ones
      next.iterations = s.iterations;
      s = std::move(next);
      last = change;
    }
    u = anderson.next(u, now);
  }
  return s;
}

PosedProblem renewed(Stack stack, const Arguments& args, const Expression A, const PosedProblem& C,
                     bool alone, PointLaws& laws) {
  Scene& before = *C.scene;
  const bool moves = args.has(p_at);
  PosedProblem posed{moves ? moved(stack, args, before) : unmoved(stack, args, before), {}};
  Scene& scene = *posed.scene;
  scene.given_weight = scene.given_weight || args.has(p_weight);
  face(stack, args, A, scene);
  take_over(before, scene);
  posed.laws = laws_at(args, before, scene, C.laws);
  laws = read_laws(stack, args, scene, begun_laws(stack, args, posed.laws), posed.laws.gap);
  if (posed.laws.gap.size() == 0) posed.laws = laws;
  if (moves) {  // a gap given elsewhere says nothing here; what the meshes tell comes first
    const Index measured = C.laws.given_gap ? 0 : static_cast<Index>(scene.paired());
    const Index rest = posed.laws.gap.size() - measured;
    posed.laws.gap.tail(rest) = laws.gap.tail(rest);
  }
  assemble(stack, args, A, scene, &before, alone);
  return posed;
}

}  // namespace frictioncg
