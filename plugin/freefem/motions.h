#pragma once
#include "freefem.h"

#include <set>

#include "large_turn.h"
#include "report.h"

namespace frictioncg {

/// The bodies that a sticking node joins to another one, or to the obstacle: friction holds them.
/// Between the faces of one body, such as a crack, it holds nothing of its motion.
inline std::set<Index> stuck_bodies(const Scene& scene, const std::vector<NodeState>& state,
                                    const std::vector<NodePlace>& places) {
  const LocalSystem& system = *scene.system;
  std::vector<Index> body(scene.ndof(), -1);
  for (const NodePlace& n : places)
    for (int c = 0; c < scene.d; ++c) body[n.dof[c]] = n.body;
  std::set<Index> stuck;
  for (Index k = 0; k < system.nodes(); ++k) {
    if (state[k] != NodeState::stick || system.system()->tangents(k) == 0) continue;
    std::set<Index> joined;
    for (Matrix::InnerIterator e(system.basis().W, system.system()->first[k]); e; ++e)
      if (e.value() != 0) joined.insert(body[e.col()]);
    if (joined.size() > 1 || !scene.pairing) stuck.insert(joined.begin(), joined.end());
  }
  return stuck;
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
  const std::set<Index> stuck = stuck_bodies(scene, s.state, places);
  const Eigen::MatrixXd W = floating_motions(*scene.system->system());
  std::vector<Vector> motions;
  for (Index k = 0; k < W.cols(); ++k)
    motions.push_back(scene.system->to_global(W.col(k), Vector::Zero(scene.ndof())));
  const auto bodies = by_body(places);
  for (const LargeTurn& turn : turns)
    if (!stuck.count(turn.body) &&
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
