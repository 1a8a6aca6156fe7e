#pragma once
#include "scene.h"

namespace frictioncg {

/// Of a field, in dofs of the scene, and as u at these nodes (d values each): the body that has
/// turned by more than small rotations can mean, hardly strained, although neither supports nor
/// friction hold it; in words, or empty. contact_nodes: those of the scene that the solution's
/// states belong to; problem, whose system sums over its processes; field_of: a motion of the
/// system's dofs as u.
std::string runaway(const Scene& scene, const Vector& field, const std::vector<NodePlace>& nodes,
                    const Vector& u, const std::vector<Index>& contact_nodes,
                    const ContactProblem& problem, const Solution& s,
                    const std::function<Vector(const Vector&)>& field_of);

/// The same of a converged field u. What counts is the whole displacement from where the geometry
/// is, the laws being those of that, not the increment.
std::string runaway(const Scene& scene, const ContactProblem& problem, const Solution& s,
                    const Vector& u);

/// In words, the motion that nothing holds, or that costs negative energy; or empty.
std::string blamed_motion(const Scene& scene, const Solution& solution);

/// The motions that nothing determines.
void report_undetermined(const Scene& scene, const Solution& solution, long verb);

}  // namespace frictioncg
