#include "motions.h"

#include <iostream>

#include "moving_obstacles.h"
#include "report.h"

namespace frictioncg {

namespace {

/// The motion q of an obstacle; extent: the largest distance of its contact points from the pivot.
RigidMotion motion_of_obstacle(const Scene& scene, Index obstacle, const Vector& q) {
  const MovingObstacles& moving = *scene.moving;
  RigidMotion m;
  m.a.head(scene.d) = q.head(scene.d);
  m.w.tail(q.size() - scene.d) = q.tail(q.size() - scene.d);
  m.c = moving.pivot[obstacle];
  for (std::size_t k = 0; k < scene.nodes.size(); ++k)
    if (moving.rigid.of_point[k] == obstacle)
      m.extent = std::max(m.extent, moving.rigid.arm[k].norm());
  return m;
}

/// A motion of the local dofs in words: of the bodies, and of the obstacles that move.
std::string describe(const Scene& scene, const Vector& motion) {
  const Vector all = scene.system->to_global(motion), u = all.head(scene.ndof());
  if (!scene.moving) return describe_motion(scene.places(), scene.d, u);
  const Index each = rigid_components(scene.d), count = scene.moving->rigid.dofs() / each;
  std::vector<RigidMotion> of_obstacle;
  Real most = u.lpNorm<Eigen::Infinity>();
  const auto way = [](const RigidMotion& m) { return m.a.norm() + m.w.norm() * m.extent; };
  for (Index o = 0; o < count; ++o) {
    of_obstacle.push_back(motion_of_obstacle(scene, o, all.segment(scene.ndof() + o * each, each)));
    most = std::max(most, way(of_obstacle.back()));
  }
  std::string text;
  if (u.lpNorm<Eigen::Infinity>() > at_rest * most)
    text = describe_motion(scene.places(), scene.d, u);
  for (Index o = 0; o < count; ++o)
    if (way(of_obstacle[o]) > at_rest * most)
      text += (text.empty() ? "" : ", with ") + describe(of_obstacle[o], scene.d) + " of " +
              name_of(*scene.moving, o);
  return text;
}

/// What holds a body where it has turned to, over what held it where it was. The middle of a round
/// body's contact stands against the turn by what the turn has moved it: 0.3 to 0.45 lasts of discs
/// that are nipped and driven at twice what friction holds and more, 0.73 of coarse balls, and 1 of
/// what stands, rolls or is turned by what sticks.
constexpr Real lasting = 0.9;

/// Whether contact holds a body against its turn, by the normals of nodes that touch and by those
/// that stick; or the turn is small, and the body did not jam. Between the faces of one body, such
/// as a crack, contact holds nothing of its motion.
/// field: in dofs of the scene; V: the turn and the motions that go along, in dofs of the system.
bool held_by_contact(const Scene& scene, const std::vector<Index>& nodes,
                     const std::vector<NodeState>& state, const System& system, const Vector& field,
                     const LargeTurn& turn, const DenseMatrix& V) {
  std::vector<Index> body(scene.ndof(), -1);
  for (const NodePlace& n : scene.places())
    for (int c = 0; c < scene.d; ++c) body[n.dof[c]] = n.body;
  const Vec3 axis = turn.motion.w.normalized();
  const Index count = static_cast<Index>(V.cols());
  StandAgainst as_given(count), as_turned(count);  // where the body was, and where it has come
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (state[k] == NodeState::separated) continue;
    std::set<Index> joined;  // bodies: one before an obstacle or on a crack, else two
    const Index row = scene.system->system()->first[nodes[k]];
    for (Matrix::InnerIterator e(scene.system->basis().W, row); e; ++e)
      if (e.value() != 0) joined.insert(body[e.col()]);
    const bool acts =
        joined.count(turn.body) && (joined.size() >= 2 || scene.on_obstacle(nodes[k]));
    const BoundaryNode& node = scene.contact_point(nodes[k]);
    const Index first = system.first[static_cast<Index>(k)];
    const Index last =
        state[k] == NodeState::stick ? system.first[static_cast<Index>(k) + 1] : first + 1;
    for (Index i = first; i < last; ++i) {
      Vector against = V.row(i).transpose();
      as_given.add(against);
      if (i == first && acts) {  // to first order, an obstacle's normals staying what they are
        Vec3 moved = -turn.motion.a;
        for (int c = 0; c < scene.d; ++c) moved[c] += field[node.point.dof[c]];
        const Real of_slave = body[node.point.dof[0]] == turn.body ? 1 : -1;
        against[0] += of_slave * node.point.normal.dot(axis.cross(moved));
      }
      as_turned.add(against);
    }
    for (StandAgainst* contact : {&as_given, &as_turned})
      if (acts) contact->add_way(axis.cross(node.x - turn.motion.c));
  }
  as_given.sum(system);
  as_turned.sum(system);
  const Real angle = turn.motion.w.norm();
  return as_given.holds(angle) ? as_turned.share() > lasting * as_given.share()
                               : angle <= small_turn;
}

}  // namespace

std::string runaway(const Scene& scene, const Vector& field, const std::vector<NodePlace>& nodes,
                    const Vector& u, const std::vector<Index>& contact_nodes,
                    const std::vector<NodeState>& state, const System& system,
                    const std::function<Vector(const Vector&)>& field_of) {
  const int d = scene.d;
  const std::vector<LargeTurn> turns = large_turns(nodes, d, u, jamming_turn);
  if (turns.empty()) return "";
  const DenseMatrix W = floating_motions(system);
  std::vector<Vector> motions;
  for (Index k = 0; k < W.cols(); ++k) motions.push_back(field_of(W.col(k)));
  const auto bodies = by_body(nodes);
  for (const LargeTurn& turn : turns) {
    const DenseMatrix by = turning(motions, bodies.at(turn.body), d, turn.motion.w.normalized());
    if (by.cols() > 0 && !held_by_contact(scene, contact_nodes, state, system, field, turn, W * by))
      return describe(turn, d);
  }
  return "";
}

std::string runaway(const Scene& scene, const Solution& s, const Vector& u) {
  if (s.status != Status::converged || u.size() == 0) return "";
  const Vector field = scene.at ? Vector(u - *scene.at) : u;
  const Real most = std::sqrt(scene.d) * field.lpNorm<Eigen::Infinity>();
  if (!(most > jamming_turn * scene.least_gyration())) return "";
  std::vector<Index> nodes(scene.system->nodes());
  std::iota(nodes.begin(), nodes.end(), 0);
  return runaway(scene, field, scene.places(), field, nodes, s.state, *scene.system->system(),
                 [&](const Vector& w) { return scene.system->to_global(w); });
}

std::string blamed_motion(const Scene& scene, const Solution& solution) {
  const Vector& motion = motion_to_blame(solution);
  return motion.size() > 0 ? describe(scene, motion) : "";
}

void report_undetermined(const Scene& scene, const Solution& solution, long verb) {
  const Index all = static_cast<Index>(solution.undetermined.cols());
  if (all == 0) return;
  const Index named = verb > 2 ? all : std::min<Index>(3, all);
  line() << "nothing determines ";
  for (Index k = 0; k < named; ++k)
    std::cout << (k > 0 ? ", nor " : "") << describe(scene, solution.undetermined.col(k));
  if (named < all) std::cout << ", nor " << all - named << " more motions, which verb=3 has";
  std::cout << "; the field has the least of " << (all > 1 ? "them" : "it") << std::endl;
}

}  // namespace frictioncg
