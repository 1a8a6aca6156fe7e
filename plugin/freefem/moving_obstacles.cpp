#include "moving_obstacles.h"

#include "outputs.h"
#include "report.h"

namespace frictioncg {

namespace {

/// "translation along y of the obstacle on label 4"
std::string component_in_words(const MovingObstacles& moving, int d, Index component) {
  const Index each = rigid_components(d), k = component % each;
  const char* const axes[] = {"x", "y", "z"};
  const std::string what = k < d    ? std::string("translation along ") + axes[k]
                           : d == 2 ? std::string("rotation")
                                    : std::string("rotation about ") + axes[k - d];
  return what + " of " + name_of(moving, component / each);
}

/// One value for each component of each obstacle.
void check_size(Parameter p, std::size_t size, const MovingObstacles& moving, int d) {
  if (static_cast<Index>(size) == moving.rigid.dofs()) return;
  const Index each = rigid_components(d), count = moving.rigid.dofs() / each;
  refuse(name_of(p), " has ", size, " values; ", count,
         (count == 1 ? " obstacle takes " : " obstacles take "), moving.rigid.dofs(), ", ",
         (d == 2 ? "2 translations and a rotation" : "3 translations and 3 rotations"), " each");
}

/// The pivots, which may depend on the label, as expressions at the contact points; by default the
/// origin.
void find_pivots(Stack stack, const Arguments& args, const Scene& scene, MovingObstacles& moving) {
  if (!args.has(p_pivot)) return;
  const auto guard = point_guard(stack);
  std::vector<char> seen(moving.pivot.size(), 0);
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    const BoundaryNode& node = scene.nodes[k];
    const Index o = moving.rigid.of_point[k];
    if (o < 0) continue;
    node.space->go_to(stack, node);
    Vec3 at = Vec3::Zero();
    for (int c = 0; c < scene.d; ++c) at[c] = args.component(stack, p_pivot, c);
    if (!at.allFinite() || (seen[o] && at != moving.pivot[o]))
      throw IllegalInput("pivot = " + mortar::place(scene.d, at) + " at " + place(node, scene.d) +
                         "; the pivot is one point of each obstacle: it may depend on the label "
                         "alone");
    moving.pivot[o] = at;
    seen[o] = 1;
  }
}

/// Refuses pivots so far from what they turn that rotations are no more than translations: each
/// digit of that distance takes two of the answer.
void refuse_far_pivots(const Scene& scene, const MovingObstacles& moving) {
  constexpr Real far = 1e4;
  const RigidObstacles& rigid = moving.rigid;
  for (std::size_t o = 0; o < moving.pivot.size(); ++o) {
    std::vector<Vec3> arms;
    for (std::size_t k = 0; k < rigid.arm.size(); ++k)
      if (rigid.of_point[k] == static_cast<Index>(o)) arms.push_back(rigid.arm[k]);
    if (arms.size() < 2) continue;
    const Extent extent = extent_of(arms);
    if (!(extent.mean.norm() > far * extent.radius)) continue;
    const Vec3 &at = moving.pivot[o], centre = at + extent.mean;
    throw IllegalInput("pivot = " + components_of(at, scene.d, 0) +
                       " is more than 10 000 times as far from its contact boundary, around " +
                       components_of(centre, scene.d, 0) +
                       ", as that is wide; give pivot= a point near it (by default it is the "
                       "origin), and motion and motionload about that");
  }
}

}  // namespace

std::string name_of(const MovingObstacles& moving, Index obstacle) {
  return moving.labels.empty() ? "the obstacle"
                               : "the obstacle on label " + std::to_string(moving.labels[obstacle]);
}

void find_obstacles(const Scene& scene, MovingObstacles& moving) {
  for (std::size_t a = 0; a < moving.labels.size(); ++a) {
    const long label = moving.labels[a];
    if (std::count(moving.labels.begin(), moving.labels.end(), label) > 1)
      refuse("obstacles has label ", label, " twice; each obstacle has a label of its own");
    const auto has_it = [label](const BoundaryNode& node) { return node.label == label; };
    if (std::none_of(scene.nodes.begin(), scene.nodes.end(), has_it))
      refuse("obstacles has label ", label,
             ", on which there is no contact node; give labels of the contact");
  }
  moving.rigid.of_point.clear();
  for (const BoundaryNode& node : scene.nodes) {
    const auto at = std::find(moving.labels.begin(), moving.labels.end(), node.label);
    const bool found = at != moving.labels.end();
    moving.rigid.of_point.push_back(moving.labels.empty() ? 0
                                    : found ? static_cast<Index>(at - moving.labels.begin())
                                            : -1);
  }
}

void set_arms(const Scene& scene, MovingObstacles& moving) {
  moving.rigid.arm.clear();
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    const Index o = moving.rigid.of_point[k];
    moving.rigid.arm.push_back(Vec3::Zero());
    if (o >= 0) moving.rigid.arm[k] = scene.nodes[k].x - moving.pivot[o];
  }
}

std::optional<MovingObstacles> read_obstacles(Stack stack, const Arguments& args,
                                              const Scene& scene) {
  if (!args.has_any(of_moving_obstacle)) return std::nullopt;
  std::optional<MovingObstacles> moving(std::in_place);
  moving->labels = args.integers(stack, p_obstacles);
  if (args.has(p_obstacles) && moving->labels.empty())
    throw IllegalInput("obstacles is empty; name the label of each obstacle that moves");
  find_obstacles(scene, *moving);
  const std::size_t count = std::max<std::size_t>(1, moving->labels.size());
  moving->pivot.assign(count, Vec3::Zero());
  moving->rigid.free.assign(count * rigid_components(scene.d), 0);
  find_pivots(stack, args, scene, *moving);
  set_arms(scene, *moving);
  refuse_far_pivots(scene, *moving);
  if (!args.has(p_motionfree)) return moving;
  const std::vector<long> free = args.integers(stack, p_motionfree);
  check_size(p_motionfree, free.size(), *moving, scene.d);
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (free[k] != 0 && free[k] != 1)
      refuse("motionfree[", k, "] = ", free[k],
             "; 1 is a component that is free under its load, 0 one that is given");
    moving->rigid.free[k] = static_cast<char>(free[k]);
  }
  return moving;
}

void warn_of_turns(const Scene& scene, const Vector& moved) {
  for (Index k = 0; k < scene.moving->rigid.dofs(); ++k) {
    const Real turn = std::abs(moved[scene.ndof() + k]);
    if (k % rigid_components(scene.d) >= scene.d && turn > small_turn)
      line() << "the " << component_in_words(*scene.moving, scene.d, k) << " is " << turn
             << " radians: the laws are those of small rotations" << std::endl;
  }
}

void write_motions(const Scene& scene, const Solution& s, const Vector& moved, const Motions& out) {
  const Index n = scene.moving->rigid.dofs();
  write(moved.tail(n), out.motion);
  if (out.force) write(-scene.system->force_to_global(contact_forces(scene, s)).tail(n), out.force);
}

void with_components_in_words(const Scene& scene, const std::function<void()>& make) {
  try {
    make();
  } catch (const UselessComponent& e) {
    refuse("motionfree[", e.component, "] = 1, but the ",
           component_in_words(*scene.moving, scene.d, e.component),
           " moves no contact node, and nothing says what it is; set 0 there");
  }
}

void Motions::complete(const MovingObstacles& moving, int d) {
  const RigidObstacles& rigid = moving.rigid;
  const Index n = rigid.dofs();
  const auto refuse_value = [&](Parameter p, Index k, Real value, const char* why) {
    refuse(name_of(p), "[", k, "] = ", value, " is of the ", component_in_words(moving, d, k), why);
  };
  const auto fill = [&](Parameter p, bool given, Vector& v) {
    if (!given) v = Vector::Zero(n);
    check_size(p, v.size(), moving, d);
    for (Index k = 0; k < n; ++k)
      if (!std::isfinite(v[k])) refuse_value(p, k, v[k], "; it is a finite number");
  };
  fill(p_motion, guess.size() > 0, guess);
  fill(p_motionold, before.size() > 0, before);
  const bool any_free = std::count(rigid.free.begin(), rigid.free.end(), 1) > 0;
  if (any_free && !args.has(p_motionload))
    throw IllegalInput(
        "motionfree sets obstacles free, but there is no motionload; give the forces and moments "
        "on them, 0 where nothing loads them");
  fill(p_motionload, args.has(p_motionload), load);
  for (Index k = 0; k < n; ++k) {
    if (rigid.free[k]) continue;
    if (load[k] != 0)
      refuse_value(p_motionload, k, load[k],
                   ", but it is given by motion; set motionfree to 1 there, or the load to 0");
    load[k] = guess[k];
  }
}

}  // namespace frictioncg
