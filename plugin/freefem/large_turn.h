#pragma once
#include <Eigen/Dense>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

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
    const Eigen::Vector3d mean = extent_of(body).mean;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (const NodePlace& n : body) {
      const Eigen::Vector3d arm = position(n) - mean;
      inertia += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
    }
    const Real about_axis = d == 2 ? inertia(2, 2) : eigenpairs(inertia).values[0];
    least = std::min(least, std::sqrt(std::max<Real>(0, about_axis) / Real(body.size())));
  }
  return least;
}

/// Whether fields, motions that A leaves free, turn a body about an axis (a unit vector): where
/// none does, supports hold it, or drive it.
inline bool leave_free_to_turn(const std::vector<Vector>& motions,
                               const std::vector<NodePlace>& body, int d,
                               const Eigen::Vector3d& axis) {
  constexpr Real none = 1e-6;  // over the largest displacement of the motion
  Eigen::Matrix3Xd turns(3, 0);
  for (const Vector& u : motions) {
    const RigidMotion m = nearest_rigid_motion(body, d, u);
    const Eigen::Vector3d turn = m.w * m.extent;
    if (!(turn.norm() > none * u.lpNorm<Eigen::Infinity>())) continue;
    turns.conservativeResize(3, turns.cols() + 1);
    turns.rightCols(1) = turn.normalized();
  }
  if (turns.cols() == 0) return false;
  const Eigen::VectorXd c = least_squares(turns, axis);
  return (turns * c - axis).norm() < 0.5;
}

/// What the normals of touching nodes say to a rotation w about c: of q_i = n_i.(w x (x_i - c))
/// what no translation a, n_i.a, makes good, by sums over the nodes.
struct StandAgainst {
  Eigen::Matrix<Real, 5, 5> vv = Eigen::Matrix<Real, 5, 5>::Zero();  ///< v: n, q, |w x (x - c)|

  void add(const Eigen::Vector3d& n, const Eigen::Vector3d& x, const RigidMotion& m) {
    const Eigen::Vector3d way = m.w.cross(x - m.c);
    Eigen::Matrix<Real, 5, 1> v;
    v << n, n.dot(way), way.norm();
    vv += v * v.transpose();
  }
  void sum(const System& system) { system.sum(vv.data(), static_cast<Index>(vv.size())); }
  /// Contact itself holds the body against the turn: a floor or a slope, 0.3 and more of the way.
  /// Errors of normals make a few hundredths, surfaces of revolution and faces of a crack nothing.
  bool holds() const {
    constexpr Real clearly = 0.1;  // of the way
    const Eigen::Matrix3d nn = vv.topLeftCorner<3, 3>();
    const Eigen::Vector3d nq = vv.col(3).head<3>();
    const Real left = vv(3, 3) - nq.dot(Vector(least_squares(nn, nq)));
    return left > clearly * clearly * vv(4, 4);
  }
};

/// What the call has to say of such a body.
inline std::string describe(const LargeTurn& turn, int d) {
  std::ostringstream s;
  s.precision(3);
  s << "the body around " << components_of(turn.motion.c, d, 1e-6 + turn.motion.c.norm())
    << " has turned by " << turn.motion.w.norm() << " radians, " << describe(turn.motion, d)
    << ", and is strained by no more than " << turn.strain
    << ": small rotations cannot mean that, and nothing holds it but the error of the normals, or "
       "the couple of friction and a gap";
  return s.str();
}

}  // namespace frictioncg
