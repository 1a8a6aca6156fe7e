#pragma once
#include "scene.h"

namespace frictioncg {

class Progress;

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

/// r = F - Ax without what separated nodes have of it: no more than the residual, and no force.
/// What is more is the shear of a given limit, which acts without pressure, too.
Vector contact_forces(const Scene& scene, const Solution& s);

/// Fills all but the times.
void write_outputs(const Scene& scene, const Solution& solution, const PointLaws& laws,
                   const Progress& progress, const Outputs& out);

}  // namespace frictioncg
