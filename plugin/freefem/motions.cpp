#include "motions.h"

#include <iostream>

#include "../core/model/rigid_candidates.h"
#include "../core/statics/floating.h"
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
/// that are nipped and driven at twice what friction holds and more, 0.73 of coarse balls, 1 -
/// 1/q^2 of ellipses that bind, whose forces are too large by as much, and 1 of what stands or
/// rolls.
constexpr Real lasting = 0.85;

/// Of what contact can hold, the share from which on edges hold too much. Blocks of unlike
/// stiffness that lean on one another have 0.14; a cylinder in a groove at 1.2 times the torque
/// that friction holds, and a pyramid of discs at half of the friction that it needs, 0.14 to 0.2.
constexpr Real edges = 0.15;

/// The nodes that touch, and the bodies that they join.
class Contacts {
 public:
  /// nodes: those of the scene that the states belong to
  Contacts(const Scene& scene, const std::vector<Index>& nodes, const ContactProblem& problem,
           const Solution& s)
      : scene_(scene),
        nodes_(nodes),
        problem_(problem),
        solution_(s),
        system_(*problem.system),
        body_(body_of_dofs(scene.places(), scene.d, scene.ndof())),
        joined_(nodes.size()),
        groups_(Index(system_.largest(Real(count_bodies(scene.places()))))) {
    std::vector<Real> pairs;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Index row = scene.system->system()->first[nodes[k]];
      for (Matrix::InnerIterator e(scene.system->basis().W, row); e; ++e)
        if (e.value() != 0 && body_[e.col()] >= 0) joined_[k].insert(body_[e.col()]);
      if (is_open(k)) continue;
      for (Index body : joined_[k])
        pairs.insert(pairs.end(), {Real(*joined_[k].begin()), Real(body)});
    }
    const Vector all =
        system_.gathered(Eigen::Map<const Vector>(pairs.data(), Index(pairs.size())));
    for (Index k = 0; k < all.size(); k += 2) groups_.join(Index(all[k]), Index(all[k + 1]));
  }

  /// Bodies that touch, one by one, have one number.
  Index group_of(Index body) { return groups_.of(body); }

  /// How contact holds a body against its turn, by the normals of nodes that touch and by those
  /// that stick. Between the faces of one body, such as a crack, contact holds nothing of its
  /// motion. field: in dofs of the scene; V: the turn and the motions that go along, in dofs of the
  /// system.
  Hold on(const LargeTurn& turn, const Vector& field, const DenseMatrix& V) {
    const Vec3 axis = turn.motion.w.normalized();
    const Index count = static_cast<Index>(V.cols());
    StandAgainst as_given(count), as_turned(count);  // where the body was, and where it has come
    StandOnEdge on_edge;
    bool touches = false;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      const std::set<Index>& joined = joined_[k];
      if (joined.empty() || group_of(*joined.begin()) != group_of(turn.body)) continue;
      const bool acts =
          joined.count(turn.body) && (joined.size() >= 2 || scene_.on_obstacle(nodes_[k]));
      const BoundaryNode& node = scene_.contact_point(nodes_[k]);
      if (is_open(k)) {
        if (acts) on_edge.add(turn.motion, node.x, node.point.normal, 0, 0);
        continue;
      }
      touches = true;
      const Real of_slave = body_[node.point.dof[0]] == turn.body ? 1 : -1;
      const Index first = system_.first[static_cast<Index>(k)];
      const bool sticks = solution_.state[k] == NodeState::stick;
      const Index last = sticks ? system_.first[static_cast<Index>(k) + 1] : first + 1;
      for (Index i = first; i < last; ++i) {
        Vector against = V.row(i).transpose();
        as_given.add(against);
        if (i == first && acts) {  // to first order, an obstacle's normals staying what they are
          Vec3 moved = -turn.motion.a;
          for (int c = 0; c < scene_.d; ++c) moved[c] += field[node.point.dof[c]];
          against[0] += of_slave * node.point.normal.dot(axis.cross(moved));
        }
        as_turned.add(against);
      }
      if (!acts) continue;
      for (StandAgainst* contact : {&as_given, &as_turned})
        contact->add_way(axis.cross(node.x - turn.motion.c));
      const Real r_N = solution_.certificate.r[first];
      on_edge.add(turn.motion, node.x, node.point.normal, -of_slave * r_N,
                  law_of(problem_.increment, Index(k)).limit(r_N));
    }
    // what nothing presses is held by supports, though with a motion to spare
    if (system_.largest(touches) == 0) return Hold::lasts;
    as_given.sum(system_);
    as_turned.sum(system_);
    const Real angle = turn.motion.w.norm();
    if (!as_given.holds(angle) || (turn.large && angle > too_far))
      return turn.large ? Hold::none : Hold::lasts;
    on_edge.sum(system_);
    if (on_edge.share() > edges) return Hold::rolls;
    return as_turned.share() > lasting * as_given.share() ? Hold::lasts : Hold::jams;
  }

 private:
  bool is_open(std::size_t k) const { return solution_.state[k] == NodeState::separated; }

  const Scene& scene_;
  const std::vector<Index>& nodes_;
  const ContactProblem& problem_;
  const Solution& solution_;
  const System& system_;
  std::vector<Index> body_;              ///< per dof of the scene
  std::vector<std::set<Index>> joined_;  ///< per node: one before an obstacle or on a crack, or two
  Groups groups_;                        ///< of bodies
};

/// The turn by 1 that supports resist least, n x 1, of motions V (n x k) of which the first is a
/// turn by 1 and the others are none. Without columns where supports resist it more than the forces
/// of contact drive it, theta q'Aq >= |q'r|, or V has none.
DenseMatrix weakly_resisted(const System& system, const DenseMatrix& V, const Vector& r,
                            Real theta) {
  if (V.cols() == 0) return V;
  DenseMatrix AV(V.rows(), V.cols());
  for (Eigen::Index k = 0; k < V.cols(); ++k) {
    Vector Av;
    system.multiply(V.col(k), Av);
    AV.col(k) = Av;
  }
  DenseMatrix K = V.transpose().lazyProduct(AV);
  system.sum(K.data(), static_cast<Index>(K.size()));
  const Eigen::Index others = V.cols() - 1;
  constexpr Real none = 1e-9;  // over what resists most: below, rounding of a body on soft springs
  const Vector of_turn = K.col(0).tail(others),
               along = least_squares(K.bottomRightCorner(others, others), of_turn, none);
  const Vector q = V.col(0) - V.rightCols(others) * along;
  const Real energy = K(0, 0) - along.dot(of_turn), work = system.sum(q.dot(r));
  return theta * energy < std::abs(work) ? DenseMatrix(q) : DenseMatrix(V.rows(), 0);
}

/// Of rigid motions of bodies, so many of each, those of one; all, where they are of all as if they
/// were one.
DenseMatrix of_body(const Matrix& motions, Index each, Index place, Index bodies) {
  if (motions.cols() != each * bodies) return DenseMatrix(motions);
  return DenseMatrix(motions.middleCols(each * place, each));
}

}  // namespace

std::string runaway(const Scene& scene, const Vector& field, const std::vector<NodePlace>& nodes,
                    const Vector& u, const std::vector<Index>& contact_nodes,
                    const ContactProblem& problem, const Solution& s,
                    const std::function<Vector(const Vector&)>& field_of) {
  const int d = scene.d;
  const std::vector<LargeTurn> turns = large_turns(nodes, d, u);
  if (turns.empty()) return "";
  const auto fields_of = [&](const DenseMatrix& motions) {
    std::vector<Vector> fields;
    for (Eigen::Index k = 0; k < motions.cols(); ++k) fields.push_back(field_of(motions.col(k)));
    return fields;
  };
  const System& system = *problem.system;
  const DenseMatrix W = floating_motions(system);
  const Matrix candidates = rigid_candidates(system);
  const std::vector<Vector> fields = fields_of(W);
  const auto bodies = by_body(nodes);
  Contacts contacts(scene, contact_nodes, problem, s);
  std::vector<std::set<Index>> moved(fields.size());  // groups of bodies, by each of W
  for (std::size_t k = 0; k < fields.size(); ++k)
    for (const auto& [number, body] : bodies)
      if (largest_displacement(body, d, fields[k]) > 0) moved[k].insert(contacts.group_of(number));
  for (const LargeTurn& turn : turns) {
    const auto body = bodies.find(turn.body);
    const Vec3 axis = turn.motion.w.normalized();
    std::vector<Vector> along;  // of W, what can go along
    EntryList chosen;
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (moved[k].count(contacts.group_of(turn.body)) == 0) continue;
      chosen.emplace_back(Index(k), Index(along.size()), 1);
      along.push_back(fields[k]);
    }
    const DenseMatrix W_along = W * sparse(Index(W.cols()), Index(along.size()), chosen);
    DenseMatrix V = W_along * turning(along, body->second, d, axis);
    if (V.cols() == 0) {  // supports resist the turn
      const DenseMatrix own =
          of_body(candidates, rigid_components(d), Index(std::distance(bodies.begin(), body)),
                  Index(bodies.size()));
      const DenseMatrix q =
          weakly_resisted(system, own * turning(fields_of(own), body->second, d, axis),
                          s.certificate.r, turn.motion.w.norm());
      if (q.cols() == 0) continue;
      V.resize(q.rows(), 1 + W_along.cols());
      V << q, W_along;
    }
    const Hold hold = contacts.on(turn, field, V);
    if (hold != Hold::lasts) return describe(turn, d, hold);
  }
  return "";
}

std::string runaway(const Scene& scene, const ContactProblem& problem, const Solution& s,
                    const Vector& u) {
  if (s.status != Status::converged || u.size() == 0) return "";
  const Vector field = scene.at ? Vector(u - *scene.at) : u;
  const Real most = std::sqrt(scene.d) * field.lpNorm<Eigen::Infinity>();
  if (!(most > jamming_turn * scene.least_gyration())) return "";
  std::vector<Index> nodes(scene.system->nodes());
  std::iota(nodes.begin(), nodes.end(), 0);
  return runaway(scene, field, scene.places(), field, nodes, problem, s,
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
