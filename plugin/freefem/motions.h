#pragma once
#include "scene.h"

namespace frictioncg {

/// Whether contact holds a body against its turn, by the normals of nodes that touch and by those
/// that stick. Between the faces of one body, such as a crack, it holds nothing of its motion.
/// nodes: the contact nodes of the scene that the states belong to; system: sums over its
/// processes; V: the turn and the motions that go along, in its dofs.
bool held_by_contact(const Scene& scene, const std::vector<Index>& nodes,
                     const std::vector<NodeState>& state, const System& system,
                     const LargeTurn& turn, const DenseMatrix& V);

/// Of a field u (d values a node): the body that has turned by more than small rotations can mean,
/// hardly strained, although neither supports nor friction hold it; in words, or empty. field_of:
/// a motion of the system's dofs as u; held: by contact.
std::string runaway(const std::vector<NodePlace>& nodes, int d, const Vector& u,
                    const System& system, const std::function<Vector(const Vector&)>& field_of,
                    const std::function<bool(const LargeTurn&, const DenseMatrix&)>& held);

/// The same of a converged field u. What counts is the whole displacement from where the geometry
/// is, the laws being those of that, not the increment.
std::string runaway(const Scene& scene, const Solution& s, const Vector& u);

/// In words, the motion that nothing holds, or that costs negative energy; or empty.
std::string blamed_motion(const Scene& scene, const Solution& solution);

/// The motions that nothing determines.
void report_undetermined(const Scene& scene, const Solution& solution, long verb);

}  // namespace frictioncg
