#pragma once
#include "freefem.h"

#include "call.h"
#include "contactproblem.h"

namespace frictioncg {

/// Whether contact points are at the same nodes.
inline bool same_points(const std::vector<BoundaryNode>& one,
                        const std::vector<BoundaryNode>& other) {
  return std::equal(
      one.begin(), one.end(), other.begin(), other.end(),
      [](const BoundaryNode& p, const BoundaryNode& q) { return p.point.dof == q.point.dof; });
}

/// The points on an obstacle with the normals and weights of the call, or as they were.
inline void place_obstacle(Stack stack, const Arguments& args, Scene& scene) {
  const Parameter normal = scene.pairing ? p_obstaclenormal : p_normal;
  if (!args.has(normal) && (!args.has(p_weight) || scene.on_mesh.empty())) {
    scene.nodes.erase(scene.nodes.begin(), scene.nodes.begin() + static_cast<long>(scene.paired()));
    return;
  }
  if (!args.has(normal) && scene.given_normals)
    throw IllegalInput(std::string("weight is given with the new matrix, and ") +
                       parameters[normal].name + ", which C was made with, is not; give both");
  scene.nodes = scene.on_mesh;
  scene.averted.clear();
  set_weights(stack, args, scene);
  set_normals(stack, args, scene);
}

/// The geometry of C at the displacement of the call, which names anew what C was given at places.
inline std::shared_ptr<Scene> moved(Stack stack, const Arguments& args, const Scene& before) {
  const std::shared_ptr<Scene> scene = before.moved_to(read_stage(stack, args));
  const auto require = [&](Parameter p, bool given) {
    if (given && !args.has(p))
      throw IllegalInput(std::string("at moves the nodes of C, and ") + parameters[p].name +
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

/// Points that have been found anew take from those before what no such call names.
inline void take_over(const Scene& before, Scene& scene) {
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
inline bool names_friction(const Arguments& args, const PointLaws& laws) {
  if (laws.law == Law::frictionless || args.has(p_slidinglimit)) return true;
  if (laws.law == Law::tresca) return args.has_any(frictions);
  const auto named = [&](Parameter p, const Vector& v) {
    return v.size() == 0 || v.isZero(0) || args.has(p);
  };
  return named(p_mu, laws.mu) && named(p_cohesion, laws.cohesion) && named(p_shearmax, laws.cap);
}

/// The laws of C at the points of its scene as it is posed anew: where these are others, the call
/// has to name what C had.
inline PointLaws laws_at(const Arguments& args, const Scene& before, const Scene& scene,
                         PointLaws laws) {
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

/// What was given as a gap elsewhere says nothing here: C takes that of the call, but for the first
/// `measured`, which the meshes tell.
inline void keep_gap(const PointLaws& of_call, Index measured, PointLaws& of_C) {
  const Index rest = of_C.gap.size() - measured;
  of_C.gap.tail(rest) = of_call.gap.tail(rest);
}

/// C with the script's matrix as it is now, and with what the call names of its geometry. alone:
/// nobody else has the scene of C, which then gives its solver away. laws: those of the call.
/// Whatever is refused, C stays as it was.
inline PosedProblem renewed(Stack stack, const Arguments& args, const Expression A,
                            const PosedProblem& C, bool alone, PointLaws& laws) {
  Scene& before = *C.scene;
  const bool moves = args.has(p_at);
  PosedProblem posed{moves ? moved(stack, args, before) : before.posed_anew(), {}};
  Scene& scene = *posed.scene;
  if (!moves) place_obstacle(stack, args, scene);
  scene.given_weight = scene.given_weight || args.has(p_weight);
  if (scene.nodes.empty() && !scene.averted.empty()) refuse_inward(scene);
  follow_free_motions(stack, A, scene);
  if (scene.pairing) face_bodies(stack, args, A, scene);
  take_over(before, scene);
  posed.laws = laws_at(args, before, scene, C.laws);
  laws = read_laws(stack, args, scene, begun_laws(stack, args, posed.laws), posed.laws.gap);
  if (posed.laws.gap.size() == 0) posed.laws = laws;
  if (moves) keep_gap(laws, C.laws.given_gap ? 0 : static_cast<Index>(scene.paired()), posed.laws);
  const Triplets matrix = read_matrix(stack, A, scene);
  assemble(matrix, scene, read_verb(stack, args),
           [&](const Triplets& M) { scene.assemble_after(before, M, alone); });
  return posed;
}

}  // namespace frictioncg
