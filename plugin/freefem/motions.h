#pragma once
#include "freefem.h"

#include <set>

#include "large_turn.h"
#include "report.h"

namespace frictioncg {

/// The bodies that a contact node is of: one before an obstacle or on a crack, else two.
inline std::set<Index> bodies_at(const Scene& scene, Index k, const std::vector<Index>& body) {
  const LocalSystem& system = *scene.system;
  std::set<Index> joined;
  for (Matrix::InnerIterator e(system.basis().W, system.system()->first[k]); e; ++e)
    if (e.value() != 0) joined.insert(body[e.col()]);
  return joined;
}

inline void add(const BoundaryNode& node, const RigidMotion& m, StandAgainst& normals) {
  const std::array<Real, 3>& n = node.point.normal;
  normals.add({n[0], n[1], n[2]}, {node.x.x, node.x.y, node.x.z}, m);
}

/// Whether contact holds a body against its turn: by a node that sticks to another body or to the
/// obstacle (between the faces of one body, such as a crack, it holds nothing of its motion), or by
/// the normals of those that touch.
inline bool held_by_contact(const Scene& scene, const std::vector<NodeState>& state,
                            const std::vector<Index>& body, const LargeTurn& turn) {
  StandAgainst normals;
  for (Index k = 0; k < scene.system->nodes(); ++k) {
    if (state[k] == NodeState::separated) continue;
    const std::set<Index> joined = bodies_at(scene, k, body);
    if (!joined.count(turn.body) || (joined.size() < 2 && scene.pairing)) continue;
    if (state[k] == NodeState::stick && scene.system->system()->tangents(k) > 0) return true;
    add(scene.contact_point(k), turn.motion, normals);
  }
  return normals.holds();
}

/// Of a converged field: the body that has turned by more than small rotations can mean, hardly
/// strained, although neither supports nor friction hold it; in words, or empty. The whole
/// displacement counts, not the increment: the laws are those of the mesh as it is given.
inline std::string runaway(const Scene& scene, const Solution& s, const Vector& field) {
  if (s.status != Status::converged || field.size() == 0) return "";
  const Real most = std::sqrt(scene.d) * field.lpNorm<Eigen::Infinity>();
  if (!(most > small_turn * scene.least_gyration())) return "";
  const std::vector<NodePlace> places = scene.places();
  const std::vector<LargeTurn> turns = large_turns(places, scene.d, field);
  if (turns.empty()) return "";
  std::vector<Index> body(scene.ndof(), -1);
  for (const NodePlace& n : places)
    for (int c = 0; c < scene.d; ++c) body[n.dof[c]] = n.body;
  const Eigen::MatrixXd W = floating_motions(*scene.system->system());
  std::vector<Vector> motions;
  for (Index k = 0; k < W.cols(); ++k)
    motions.push_back(scene.system->to_global(W.col(k), Vector::Zero(scene.ndof())));
  const auto bodies = by_body(places);
  for (const LargeTurn& turn : turns)
    if (!held_by_contact(scene, s.state, body, turn) &&
        leave_free_to_turn(motions, bodies.at(turn.body), scene.d, turn.motion.w.normalized()))
      return describe(turn, scene.d);
  return "";
}

/// A motion of the local dofs in words.
inline std::string describe(const Scene& scene, const Vector& motion) {
  return describe_motion(scene.places(), scene.d,
                         scene.system->to_global(motion, Vector::Zero(scene.ndof())));
}

/// The motions that a call leaves open: one that nothing holds, some that nothing determines, or a
/// body that has turned too far.
inline void report_motions(const Scene& scene, const Solution& solution, const std::string& turned,
                           long verb) {
  if (!turned.empty()) line() << turned << std::endl;
  if (solution.unheld_motion.size() > 0)
    line() << "nothing holds " << describe(scene, solution.unheld_motion) << std::endl;
  const Index all = static_cast<Index>(solution.undetermined.cols());
  const Index named = verb > 2 ? all : std::min<Index>(3, all);
  for (Index k = 0; k < named; ++k)
    line() << "nothing determines " << describe(scene, solution.undetermined.col(k))
           << "; the field has the least of it" << std::endl;
  if (named < all)
    line() << "nothing determines " << all - named << " more motions; verb=3 has each" << std::endl;
}

}  // namespace frictioncg
