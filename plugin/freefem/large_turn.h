#pragma once
#include <Eigen/Geometry>

#include "../core/model/system.h"
#include "rigid_motion.h"

namespace frictioncg {

/// A rotation [rad] beyond what the linear laws can mean: the next term, its square over 2, is
/// 5e-3. With the bound on the strain, gross falsehoods are 5 to 1000 times above both, and the
/// nearest honest body lies 20 times below one of them.
constexpr Real small_turn = 0.1;
constexpr Real stiff_turn = 30;  ///< rotation over strain: loads that turn a body far strain it

/// A body that a field turns by more than small rotations can mean, and hardly strains.
struct LargeTurn {
  Index body = 0;
  RigidMotion motion;
  Real strain = 0;  ///< what is left beside the rigid motion, over the extent
};

/// Such bodies among all nodes. Translations, and rotations of bodies that are strained as much, do
/// not count: the linear laws allow them, in any units.
inline std::vector<LargeTurn> large_turns(const std::vector<NodePlace>& nodes, int d,
                                          const Vector& u) {
  std::vector<LargeTurn> turns;
  for (const auto& [number, body] : by_body(nodes)) {
    const RigidMotion motion = nearest_rigid_motion(body, d, u);
    const Real turn = motion.w.norm();
    if (!(turn > small_turn)) continue;
    const Real strain = motion.misfit * largest_displacement(body, d, u) / motion.extent;
    if (turn > stiff_turn * strain) turns.push_back({number, motion, strain});
  }
  return turns;
}

/// The least radius of gyration of a body, over bodies and axes: a field that turns one by w has
/// displacements of at least w times as much.
inline Real least_gyration(const std::vector<NodePlace>& nodes, int d) {
  Real least = std::numeric_limits<Real>::infinity();
  for (const auto& [number, body] : by_body(nodes)) {
    const Eigen::Matrix3d inertia = inertia_of(body, extent_of(body).mean);
    const Real about_axis = d == 2 ? inertia(2, 2) : eigenpairs(inertia).values[0];
    least = std::min(least, std::sqrt(std::max<Real>(0, about_axis) / Real(body.size())));
  }
  return least;
}

/// Of fields, motions that A leaves free, the combinations (k x 1 and more) that turn a body: the
/// first by an axis (a unit vector), the others not at all. Without columns where none turns it
/// about that axis: supports hold it, or drive it.
inline DenseMatrix turning(const std::vector<Vector>& motions, const std::vector<NodePlace>& body,
                           int d, const Eigen::Vector3d& axis) {
  constexpr Real none = 1e-6;  // over the largest displacement of the motion
  const Index k = static_cast<Index>(motions.size());
  DenseMatrix turns = DenseMatrix::Zero(3, k);
  for (Index j = 0; j < k; ++j) {
    const RigidMotion m = nearest_rigid_motion(body, d, motions[j]);
    if (m.w.norm() * m.extent > none * motions[j].lpNorm<Eigen::Infinity>()) turns.col(j) = m.w;
  }
  if (turns.isZero(0)) return DenseMatrix(k, 0);
  const DenseMatrix first = least_squares(turns, axis),
                    others = null_space(turns, none * turns.norm());
  if (!((turns * first - axis).norm() < 0.5)) return DenseMatrix(k, 0);
  DenseMatrix all(k, 1 + others.cols());
  all << first, others;
  return all;
}

/// What touching nodes say to a turn by 1 with which other motions, that do not turn the body, go
/// along as they like: to its way what is against closed normals, and against stick.
class StandAgainst {
 public:
  /// motions: the turn and the others.
  explicit StandAgainst(Index motions) : sums_(Vector::Zero(motions * motions + 1)) {}
  /// against: what each of the motions does against one component of a node.
  void add(const Vector& against) {
    const DenseMatrix product = against * against.transpose();
    sums_.head(product.size()) += product.reshaped();
  }
  /// The way of a node of the body: axis x (x - centre).
  void add_way(const Eigen::Vector3d& way) { sums_.tail(1)[0] += way.squaredNorm(); }
  void sum(const System& system) { system.sum(sums_.data(), static_cast<Index>(sums_.size())); }

  /// Whether the contact holds the body against a turn by so many radians. A floor or a slope
  /// stands against 0.3 and more of the way, whatever sticks at both ends of the body against all
  /// of it. Errors of normals make a few hundredths, surfaces of revolution and faces of a crack
  /// nothing; a round body that sticks stands on the width of its contact, over the arm, and rolls
  /// on where it has come further than that. What stands on a slope is wider, over its height.
  bool holds(Real turn) const {
    constexpr Real clearly = 0.2;
    const Index k = static_cast<Index>(std::lround(std::sqrt(Real(sums_.size() - 1)))),
                rest = k - 1;
    const DenseMatrix G = sums_.head(k * k).reshaped(k, k);
    Real left = G(0, 0);
    if (rest > 0) {
      const Vector along = G.col(0).tail(rest);
      left -= along.dot(Vector(least_squares(G.bottomRightCorner(rest, rest), along)));
    }
    const Real least = std::min(turn / 2, clearly);
    return left > least * least * sums_.tail(1)[0];
  }

 private:
  Vector sums_;
};

/// What the call has to say of such a body.
inline std::string describe(const LargeTurn& turn, int d) {
  std::ostringstream s;
  s.precision(3);
  s << "the body around " << components_of(turn.motion.c, d, 1e-6 + turn.motion.c.norm())
    << " has turned by " << turn.motion.w.norm() << " radians, " << describe(turn.motion, d)
    << ", and is strained by no more than " << turn.strain
    << ": small rotations cannot mean that, and nothing holds it but the error of the normals, the "
       "couple of friction and a gap, or a contact on which it rolls";
  return s.str();
}

}  // namespace frictioncg
