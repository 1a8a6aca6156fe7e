#pragma once
#include "scene.h"

namespace frictioncg {

/// "the obstacle on label 4"; the only one is the obstacle.
std::string name_of(const MovingObstacles& moving, Index obstacle);

/// The obstacle of each contact point, by its label.
void find_obstacles(const Scene& scene, MovingObstacles& moving);

/// The contact points' obstacles and arms, about pivots that are known.
void set_arms(const Scene& scene, MovingObstacles& moving);

/// The obstacles that the arguments let move; none where they let none.
std::optional<MovingObstacles> read_obstacles(Stack stack, const Arguments& args,
                                              const Scene& scene);

/// What a call says of the motions: n_q values each, or none where no obstacle moves.
struct Motions {
  Stack stack;
  const Arguments& args;
  /// Of free components the load, of given ones the motion, as b has them.
  Vector load = args.vector(stack, p_motionload);
  Vector before = args.vector(stack, p_motionold);  ///< of uold
  /// Out: null where they are not asked for.
  KN<double>* motion = args.output<KN<double>>(stack, p_motion);
  KN<double>* force = args.output<KN<double>>(stack, p_motionforce);
  Vector guess = copy_of(motion);  ///< of the answer
  /// Sizes, and values; fills what is not given.
  void complete(const MovingObstacles& moving, int d);
};

/// make(), whose refusal of a component gets its words.
void with_components_in_words(const Scene& scene, const std::function<void()>& make);

/// Rotations that the linear laws cannot mean.
void warn_of_turns(const Scene& scene, const Vector& moved);

/// moved: the displacements, and the motions after them.
void write_motions(const Scene& scene, const Solution& s, const Vector& moved, const Motions& out);

}  // namespace frictioncg
