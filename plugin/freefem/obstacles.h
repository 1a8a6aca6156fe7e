#pragma once
#include "freefem.h"

#include "large_turn.h"
#include "node_values.h"
#include "outputs.h"
#include "report.h"

namespace frictioncg {

/// "the obstacle on label 4"; the only one is the obstacle.
inline std::string name_of(const MovingObstacles& moving, Index obstacle) {
  return moving.labels.empty() ? "the obstacle"
                               : "the obstacle on label " + std::to_string(moving.labels[obstacle]);
}

/// "translation along y of the obstacle on label 4"
inline std::string component_in_words(const MovingObstacles& moving, int d, Index component) {
  const Index each = rigid_components(d), k = component % each;
  const char* const axes[] = {"x", "y", "z"};
  const std::string what = k < d    ? std::string("translation along ") + axes[k]
                           : d == 2 ? std::string("rotation")
                                    : std::string("rotation about ") + axes[k - d];
  return what + " of " + name_of(moving, component / each);
}

/// One value for each component of each obstacle.
template <class Array>
void check_components(Parameter p, const Array& values, const MovingObstacles& moving, int d) {
  if (static_cast<Index>(values.size()) == moving.rigid.dofs()) return;
  const Index each = rigid_components(d), count = moving.rigid.dofs() / each;
  std::ostringstream m;
  m << parameters[p].name << " has " << values.size() << " values; " << count
    << (count == 1 ? " obstacle takes " : " obstacles take ") << moving.rigid.dofs() << ", "
    << (d == 2 ? "2 translations and a rotation" : "3 translations and 3 rotations") << " each";
  throw IllegalInput(m.str());
}

inline std::vector<long> copy_of_longs(Stack stack, const Arguments& args, Parameter p) {
  std::vector<long> copy;
  if (!args.has(p)) return copy;
  const KN_<long> values = args.value<KN_<long>>(stack, p);
  for (long k = 0; k < values.N(); ++k) copy.push_back(values[k]);
  return copy;
}

/// The obstacle of each contact point, by its label.
inline void find_obstacles(const Scene& scene, MovingObstacles& moving) {
  for (std::size_t a = 0; a < moving.labels.size(); ++a) {
    const long label = moving.labels[a];
    if (std::count(moving.labels.begin(), moving.labels.end(), label) > 1)
      throw IllegalInput("obstacles has label " + std::to_string(label) +
                         " twice; each obstacle has a label of its own");
    const auto has_it = [label](const BoundaryNode& node) { return node.label == label; };
    if (std::none_of(scene.nodes.begin(), scene.nodes.end(), has_it))
      throw IllegalInput("obstacles has label " + std::to_string(label) +
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

/// The pivots, which may depend on the label, as expressions at the contact points.
inline void find_pivots(Stack stack, const Arguments& args, const Scene& scene,
                        MovingObstacles& moving) {
  PointGuard guard(stack);
  std::vector<char> seen(moving.pivot.size(), 0);
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    const BoundaryNode& node = scene.nodes[k];
    const Index o = moving.rigid.of_point[k];
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    if (o >= 0 && args.has(p_pivot)) {
      scene.go_to(guard.point(), node);
      for (int c = 0; c < scene.d; ++c)
        at[c] =
            evaluated("pivot", [&] { return GetAny<double>((*args.vector(p_pivot)[c])(stack)); });
      if (!at.allFinite() || (seen[o] && at != moving.pivot[o]))
        throw IllegalInput("pivot = " + coordinates(Fem2D::R3(at[0], at[1], at[2]), scene.d) +
                           " at " + place(node, scene.d) +
                           "; the pivot is one point of each obstacle: it may depend on the label "
                           "alone");
    }
    if (o >= 0) moving.pivot[o] = at;
    if (o >= 0) seen[o] = 1;
  }
}

/// The contact points' obstacles and arms, about pivots that are known.
inline void set_arms(const Scene& scene, MovingObstacles& moving) {
  moving.rigid.arm.clear();
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    const Fem2D::R3& x = scene.nodes[k].x;
    const Index o = moving.rigid.of_point[k];
    moving.rigid.arm.push_back(Eigen::Vector3d::Zero());
    if (o >= 0) moving.rigid.arm[k] = Eigen::Vector3d(x.x, x.y, x.z) - moving.pivot[o];
  }
}

/// Refuses pivots so far from what they turn that rotations are no more than translations: each
/// digit of that distance takes two of the answer.
inline void refuse_far_pivots(const Scene& scene, const MovingObstacles& moving) {
  constexpr Real far = 1e4;
  const RigidObstacles& rigid = moving.rigid;
  for (std::size_t o = 0; o < moving.pivot.size(); ++o) {
    std::vector<Eigen::Vector3d> arms;
    for (std::size_t k = 0; k < rigid.arm.size(); ++k)
      if (rigid.of_point[k] == static_cast<Index>(o)) arms.push_back(rigid.arm[k]);
    if (arms.size() < 2) continue;
    const Extent extent = extent_of(arms);
    if (!(extent.mean.norm() > far * extent.radius)) continue;
    const Eigen::Vector3d &at = moving.pivot[o], centre = at + extent.mean;
    throw IllegalInput("pivot = " + components_of(at, scene.d, 0) +
                       " is more than 10 000 times as far from its contact boundary, around " +
                       components_of(centre, scene.d, 0) +
                       ", as that is wide; give pivot= a point near it (by default it is the "
                       "origin), and motion and motionload about that");
  }
}

/// The obstacles that the arguments let move; none where they let none.
inline std::optional<MovingObstacles> read_obstacles(Stack stack, const Arguments& args,
                                                     const Scene& scene) {
  if (!args.has_any(of_moving_obstacle)) return std::nullopt;
  std::optional<MovingObstacles> moving(std::in_place);
  moving->labels = copy_of_longs(stack, args, p_obstacles);
  if (args.has(p_obstacles) && moving->labels.empty())
    throw IllegalInput("obstacles is empty; name the label of each obstacle that moves");
  find_obstacles(scene, *moving);
  const std::size_t count = std::max<std::size_t>(1, moving->labels.size());
  moving->pivot.assign(count, Eigen::Vector3d::Zero());
  moving->rigid.free.assign(count * rigid_components(scene.d), 0);
  find_pivots(stack, args, scene, *moving);
  set_arms(scene, *moving);
  refuse_far_pivots(scene, *moving);
  if (!args.has(p_motionfree)) return moving;
  const std::vector<long> free = copy_of_longs(stack, args, p_motionfree);
  check_components(p_motionfree, free, *moving, scene.d);
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (free[k] != 0 && free[k] != 1)
      throw IllegalInput("motionfree[" + std::to_string(k) + "] = " + std::to_string(free[k]) +
                         "; 1 is a component that is free under its load, 0 one that is given");
    moving->rigid.free[k] = static_cast<char>(free[k]);
  }
  return moving;
}

/// What a call says of the motions: n_q values each, or none where no obstacle moves.
struct Motions {
  Vector load;    ///< of free components the load, of given ones the motion, as b has them
  Vector before;  ///< of uold
  Vector guess;   ///< of the answer
  KN<double>* motion = nullptr;  ///< out: null where it is not asked for
  KN<double>* force = nullptr;   ///< out, likewise

  Motions(Stack stack, const Arguments& args)
      : load(vector_of(stack, args, p_motionload)),
        before(vector_of(stack, args, p_motionold)),
        motion(args.output<KN<double>>(stack, p_motion)),
        force(args.output<KN<double>>(stack, p_motionforce)),
        has_load_(args.has(p_motionload)) {
    if (motion) guess = copy_of(*motion);
  }

  /// Sizes, and values; fills what is not given.
  void complete(const MovingObstacles& moving, int d) {
    const RigidObstacles& rigid = moving.rigid;
    const Index n = rigid.dofs();
    const auto fill = [&](Parameter p, bool given, Vector& v) {
      if (!given) v = Vector::Zero(n);
      check_components(p, v, moving, d);
      for (Index k = 0; k < n; ++k)
        if (!std::isfinite(v[k])) refuse(p, k, v[k], "; it is a finite number", moving, d);
    };
    fill(p_motion, guess.size() > 0, guess);
    fill(p_motionold, before.size() > 0, before);
    const bool any_free = std::count(rigid.free.begin(), rigid.free.end(), 1) > 0;
    if (any_free && !has_load_)
      throw IllegalInput(
          "motionfree sets obstacles free, but there is no motionload; give the forces and moments "
          "on them, 0 where nothing loads them");
    fill(p_motionload, has_load_, load);
    for (Index k = 0; k < n; ++k) {
      if (rigid.free[k]) continue;
      if (load[k] != 0)
        refuse(p_motionload, k, load[k],
               ", but it is given by motion; set motionfree to 1 there, or the load to 0", moving,
               d);
      load[k] = guess[k];
    }
  }

 private:
  [[noreturn]] static void refuse(Parameter p, Index k, Real value, const char* why,
                                  const MovingObstacles& moving, int d) {
    std::ostringstream m;
    m << parameters[p].name << "[" << k << "] = " << value << " is of the "
      << component_in_words(moving, d, k) << why;
    throw IllegalInput(m.str());
  }
  const bool has_load_;
};

/// make(), whose refusal of a component gets its words.
template <class Make>
void with_components_in_words(const Scene& scene, const Make& make) {
  try {
    make();
  } catch (const UselessComponent& e) {
    throw IllegalInput("motionfree[" + std::to_string(e.component) + "] = 1, but the " +
                       component_in_words(*scene.moving, scene.d, e.component) +
                       " moves no contact node, and nothing says what it is; set 0 there");
  }
}

/// Rotations that the linear laws cannot mean.
inline void warn_of_turns(const Scene& scene, const Vector& moved) {
  for (Index k = 0; k < scene.moving->rigid.dofs(); ++k) {
    const Real turn = std::abs(moved[scene.ndof() + k]);
    if (k % rigid_components(scene.d) >= scene.d && turn > small_turn)
      line() << "the " << component_in_words(*scene.moving, scene.d, k) << " is " << turn
             << " radians: the laws are those of small rotations" << std::endl;
  }
}

/// (of the script, of the obstacles)
inline Vector joined(const Vector& of_script, const Vector& of_obstacles) {
  Vector all(of_script.size() + of_obstacles.size());
  all << of_script, of_obstacles;
  return all;
}

/// moved: the displacements, and the motions after them.
inline void write_motions(const Scene& scene, const Solution& s, const Vector& moved,
                          const Motions& out) {
  const auto write = [&](const Vector& all, Real factor, KN<double>* to) {
    if (!to) return;
    to->resize(scene.moving->rigid.dofs());
    for (long k = 0; k < to->N(); ++k) (*to)[k] = factor * all[scene.ndof() + k];
  };
  write(moved, 1, out.motion);
  if (out.force) write(scene.system->force_to_global(contact_forces(scene, s)), -1, out.force);
}

}  // namespace frictioncg
