#pragma once
#include <Eigen/Geometry>

#include "assembly/slippable.h"
#include "model/system.h"

namespace frictioncg {

/// A node of the mesh: where it lies, the dofs of the d components of its displacement, and which
/// of the parts of the mesh that hang together it belongs to.
struct NodePlace {
  Vec3 x = Vec3::Zero();
  std::array<Index, 3> dof{{-1, -1, -1}};
  Index body = 0;
};

/// The mean of points, and their largest distance from it.
struct Extent {
  Vec3 mean = Vec3::Zero();
  Real radius = 0;
};

inline const Vec3& position(const NodePlace& node) { return node.x; }
inline const Vec3& position(const Vec3& x) { return x; }

/// Of nodes, or of their positions.
template <class Point>
Extent extent_of(const std::vector<Point>& points) {
  Extent e;
  for (const Point& p : points) e.mean += position(p) / static_cast<Real>(points.size());
  for (const Point& p : points) e.radius = std::max(e.radius, (position(p) - e.mean).norm());
  return e;
}

/// The translations along the axes and the rotations about the mean of the nodes, scaled to a
/// largest displacement of about 1, in the n dofs of the script: n x 3 in 2D, n x 6 in 3D. Dofs
/// that are no component of a node are 0.
Eigen::MatrixXd rigid_modes(const std::vector<NodePlace>& nodes, int d, Index n,
                            const Extent& extent);
Eigen::MatrixXd rigid_modes(const std::vector<NodePlace>& nodes, int d, Index n);

/// See BodyShape.
Real slenderness(const std::vector<NodePlace>& nodes, int d);

/// How many bodies there are, numbered from 0.
Index count_bodies(const std::vector<NodePlace>& nodes);

/// The nodes of each body, by its number.
std::map<Index, std::vector<NodePlace>> by_body(const std::vector<NodePlace>& nodes);

/// The same of each body alone, side by side; extents of all their nodes, whoever has them.
Matrix body_modes(const std::vector<std::vector<NodePlace>>& bodies,
                  const std::vector<Extent>& extents, int d, Index n);
Matrix body_modes(const std::vector<NodePlace>& nodes, int d, Index n);

/// The rigid motion u(x) = a + w x (x - c) nearest to a displacement, c the mean of the nodes; in
/// 2D only w_z differs from 0.
struct RigidMotion {
  Vec3 a = Vec3::Zero(), w = Vec3::Zero();
  Vec3 c = Vec3::Zero();
  Real extent = 0;  ///< largest distance of a node from c
  Real misfit = 0;  ///< largest deviation of the displacement, over its largest value
};

/// Least squares over the nodes: the rotation balances sum (x - c) x u against the inertia of the
/// nodes; about a line on which they all lie there is none.
RigidMotion nearest_rigid_motion(const std::vector<NodePlace>& nodes, int d, const Vector& u);

/// (1, 0, -0.5), of d components, with what is below the rounding of a motion shown as 0.
std::string components_of(const Vec3& v, int d, Real unit);

constexpr Real at_rest = 1e-6;  ///< over the largest displacement: what does not move

/// A rigid motion in words: a translation along a direction, or a rotation about a point (2D) or an
/// axis (3D).
std::string describe(const RigidMotion& m, int d);

/// The largest displacement of the nodes.
Real largest_displacement(const std::vector<NodePlace>& nodes, int d, const Vector& u);

/// The motion in words; of several bodies that do not move as one, body by body, those at rest left
/// out, each called by the mean of its nodes; of many the three that move most.
std::string describe_motion(const std::vector<NodePlace>& nodes, int d, const Vector& u);

/// A rotation [rad] beyond what the linear laws can mean: the next term, its square over 2, is
/// 5e-4, and a round body between flats has grown by so much: it jams where it would spin. With the
/// bound on the strain the nearest honest body that contact does not hold lies 6 times below one
/// of them.
constexpr Real small_turn = 0.03;

/// A rotation [rad] that no linear law can mean, whatever contact holds: a body has grown by an
/// eighth.
constexpr Real too_far = 0.5;

/// A rotation [rad] from which on a jam counts: a body that contact holds where it was, and no
/// longer where it has turned to. A round body that is pressed flat by delta R has twice its force
/// at sqrt(2 delta): of steel that is 0.001 to 0.01.
constexpr Real jamming_turn = 3e-4;

/// A body that a field turns by more than it strains it.
struct LargeTurn {
  Index body = 0;
  RigidMotion motion;
  Real strain = 0;     ///< what is left beside the rigid motion, over the extent
  bool large = false;  ///< more than small rotations can mean; else it counts as a jam alone
};

/// Such bodies among all nodes. Translations, and rotations of bodies that are strained as much, do
/// not count: the linear laws allow them, in any units.
std::vector<LargeTurn> large_turns(const std::vector<NodePlace>& nodes, int d, const Vector& u);

/// The least radius of gyration of a body, over bodies and axes: a field that turns one by w has
/// displacements of at least w times as much.
Real least_gyration(const std::vector<NodePlace>& nodes, int d);

/// Of fields, motions that A leaves free, the combinations (k x 1 and more) that turn a body: the
/// first by an axis (a unit vector), the others not at all. Without columns where none turns it
/// about that axis: supports hold it, or drive it.
DenseMatrix turning(const std::vector<Vector>& motions, const std::vector<NodePlace>& body, int d,
                    const Vec3& axis);

/// What touching nodes say to a turn by 1 with which other motions, that do not turn the body, go
/// along as they like: to its way what is against closed normals, and against stick.
class StandAgainst {
 public:
  /// motions: the turn and the others.
  explicit StandAgainst(Index motions) : sums_(Vector::Zero(motions * motions + 1)) {}
  /// against: what each of the motions does against one component of a node.
  void add(const Vector& against);
  /// The way of a node of the body: axis x (x - centre).
  void add_way(const Vec3& way) { sums_.tail(1)[0] += way.squaredNorm(); }
  void sum(const System& system) { system.sum(sums_.data(), static_cast<Index>(sums_.size())); }
  /// Whether the contact holds the body against a turn by so many radians. A floor or a slope
  /// stands against 0.3 and more of the way, whatever sticks at both ends of the body against all
  /// of it. Errors of normals make a few hundredths, surfaces of revolution and faces of a crack
  /// nothing; a round body that sticks stands on the width of its contact, over the arm, and rolls
  /// on where it has come further than that. What stands on a slope is wider, over its height.
  bool holds(Real turn) const;
  Real share() const;  ///< of the way, that the contact stands against

 private:
  Vector sums_;
};

/// What the pressures on a round body hold of its turn and do not hold where it has come, as it
/// stands on an edge of the mesh when it has rolled on to the next vertex: the lesser of their
/// moment about the axis, and of what the turn changes that by. Pressures turn with the normals
/// along the surface: fully in a hub, whatever its shape, not at all on a flat. It is told over all
/// that contact can hold.
class StandOnEdge {
 public:
  /// At x, of the obstacle or the other body on this one; normal: unit, outward from either, of a
  /// node that nothing presses, too; limit: of friction.
  void add(const RigidMotion& turn, const Vec3& x, const Vec3& normal, Real pressure, Real limit);
  void sum(const System& system);
  /// 0 for bodies that are not round, whose pressures do not all pass near the axis: they stand on
  /// the faces that they have. 0 without friction, too: nothing else could hold the turn.
  Real share() const;

 private:
  /// Their sum, what the turn changes it by, the sum of their sizes, and of those that friction and
  /// that pressures could have across the arm.
  using Moments = Eigen::Matrix<Real, 5, 1>;
  /// A node, and the angles about the axis at which it lies and to which its normal points.
  struct Node {
    Real place, normal;
    Moments moments;
  };
  Real turn_of_normals(std::size_t k) const;

  std::vector<Node> nodes_;
  Moments sums_ = Moments::Zero();
};

/// How contact holds a body against its turn: also where it has come, or the turn is small; where
/// it was alone, in a jam; where it was, by forces that do not balance where it has come; not.
enum class Hold { lasts, jams, rolls, none };

/// What the call has to say of such a body, that contact does not hold.
std::string describe(const LargeTurn& turn, int d, Hold hold = Hold::none);

}  // namespace frictioncg
