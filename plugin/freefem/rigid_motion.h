#pragma once
#include <Eigen/Geometry>

#include "../core/assembly/slippable.h"
#include "../core/linear_algebra.h"
#include "../core/types.h"

namespace frictioncg {

/// A node of the mesh: where it lies, the dofs of the d components of its displacement, and which
/// of the parts of the mesh that hang together it belongs to.
struct NodePlace {
  std::array<Real, 3> x{{0, 0, 0}};
  std::array<Index, 3> dof{{-1, -1, -1}};
  Index body = 0;
};

/// The mean of points, and their largest distance from it.
struct Extent {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Real radius = 0;
};

inline Eigen::Vector3d position(const NodePlace& node) {
  return Eigen::Map<const Eigen::Vector3d>(node.x.data());
}

inline const Eigen::Vector3d& position(const Eigen::Vector3d& x) { return x; }

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
inline Eigen::MatrixXd rigid_modes(const std::vector<NodePlace>& nodes, int d, Index n,
                                   const Extent& extent) {
  Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(n, d == 2 ? 3 : 6);
  const RigidGenerators generators(d, extent.mean, extent.radius > 0 ? extent.radius : 1);
  for (const NodePlace& p : nodes) {
    const RigidGenerators::Fields w = generators.at(position(p));
    for (int k = 0; k < d; ++k) modes.row(p.dof[k]) = w.row(k);
  }
  return modes;
}
inline Eigen::MatrixXd rigid_modes(const std::vector<NodePlace>& nodes, int d, Index n) {
  return rigid_modes(nodes, d, n, extent_of(nodes));
}

/// The nodes of each body, by its number.
inline std::map<Index, std::vector<NodePlace>> by_body(const std::vector<NodePlace>& nodes) {
  std::map<Index, std::vector<NodePlace>> bodies;
  for (const NodePlace& p : nodes) bodies[p.body].push_back(p);
  return bodies;
}

/// The same of each body alone, side by side.
inline Eigen::MatrixXd body_modes(const std::vector<NodePlace>& nodes, int d, Index n) {
  const auto bodies = by_body(nodes);
  const Index each = d == 2 ? 3 : 6;
  Eigen::MatrixXd modes(n, each * static_cast<Index>(bodies.size()));
  Index k = 0;
  for (const auto& [number, body] : bodies)
    modes.middleCols(each * k++, each) = rigid_modes(body, d, n);
  return modes;
}

/// The rigid motion u(x) = a + w x (x - c) nearest to a displacement, c the mean of the nodes; in
/// 2D only w_z differs from 0.
struct RigidMotion {
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), w = Eigen::Vector3d::Zero();
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  Real extent = 0;  ///< largest distance of a node from c
  Real misfit = 0;  ///< largest deviation of the displacement, over its largest value
};

/// u at a node; components beyond d are 0.
inline Eigen::Vector3d displacement_at(const NodePlace& n, int d, const Vector& u) {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  for (int k = 0; k < d; ++k) at[k] = u[n.dof[k]];
  return at;
}

/// Of nodes of mass 1, about a point.
inline Eigen::Matrix3d inertia_of(const std::vector<NodePlace>& nodes,
                                  const Eigen::Vector3d& about) {
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (const NodePlace& n : nodes) {
    const Eigen::Vector3d arm = position(n) - about;
    inertia += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
  }
  return inertia;
}

/// Least squares over the nodes: the rotation balances sum (x - c) x u against the inertia of the
/// nodes; about a line on which they all lie there is none.
inline RigidMotion nearest_rigid_motion(const std::vector<NodePlace>& nodes, int d,
                                        const Vector& u) {
  RigidMotion motion;
  if (nodes.empty()) return motion;
  const Extent extent = extent_of(nodes);
  motion.c = extent.mean;
  motion.extent = extent.radius;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const NodePlace& n : nodes) {
    const Eigen::Vector3d v = displacement_at(n, d, u);
    motion.a += v / static_cast<Real>(nodes.size());
    moment += (position(n) - motion.c).cross(v);
  }
  motion.w = least_squares(inertia_of(nodes, motion.c), moment);
  Real most = 0;
  for (const NodePlace& n : nodes) {
    const Eigen::Vector3d v = displacement_at(n, d, u);
    most = std::max(most, v.norm());
    motion.misfit =
        std::max(motion.misfit, (v - motion.a - motion.w.cross(position(n) - motion.c)).norm());
  }
  if (most > 0) motion.misfit /= most;
  return motion;
}

/// (1, 0, -0.5), of d components, with what is below the rounding of a motion shown as 0.
inline std::string components_of(const Eigen::Vector3d& v, int d, Real unit) {
  std::ostringstream s;
  s.precision(4);
  for (int k = 0; k < d; ++k) s << (k ? ", " : "(") << (std::abs(v[k]) < 1e-6 * unit ? 0 : v[k]);
  s << ")";
  return s.str();
}

constexpr Real rigid_misfit = 1e-3;  ///< up to which a motion is called rigid
constexpr Real still = 1e-6;         ///< over the largest displacement: what does not move
/// A rotation about a centre as many times the extent of the body away is a translation: rounding,
/// amplified by a nearly singular A, turns every translation by so much.
constexpr Real far_away = 2000;

/// A rigid motion in words: a translation along a direction, or a rotation about a point (2D) or an
/// axis (3D).
inline std::string describe(const RigidMotion& m, int d) {
  const Real turn = m.w.norm();
  if (far_away * turn * m.extent <= m.a.norm())
    return m.a.norm() > 0
               ? "a translation along " + components_of(m.a.normalized(), d, 1e6 / far_away)
               : "no motion";
  const Eigen::Vector3d axis = m.w / turn;
  const Eigen::Vector3d centre = m.c + m.w.cross(m.a) / (turn * turn);
  const std::string about = components_of(centre, d, m.extent + centre.norm());
  if (d == 2)
    return std::string("a rotation, ") + (m.w[2] > 0 ? "counter-clockwise" : "clockwise") +
           ", about " + about;
  std::string text = "a rotation about the axis " + components_of(axis, d, 1) + " through " + about;
  const Real along = m.a.dot(axis);
  if (std::abs(along) > still * turn * m.extent) text += ", with a translation along it";
  return text;
}

/// The motion of one body in words; where a part of the body moves, the node that moves most.
inline std::string describe_one(const std::vector<NodePlace>& nodes, int d, const Vector& u) {
  const RigidMotion m = nearest_rigid_motion(nodes, d, u);
  if (m.misfit > rigid_misfit) {
    const NodePlace* most = &nodes.front();
    for (const NodePlace& n : nodes)
      if (displacement_at(n, d, u).norm() > displacement_at(*most, d, u).norm()) most = &n;
    const Eigen::Vector3d x(most->x[0], most->x[1], most->x[2]);
    return "a motion of a part of the body, most at " + components_of(x, d, 1e-6 + x.norm()) +
           ", along " + components_of(displacement_at(*most, d, u).normalized(), d, 1);
  }
  return describe(m, d);
}

/// The largest displacement of the nodes.
inline Real largest_displacement(const std::vector<NodePlace>& nodes, int d, const Vector& u) {
  Real most = 0;
  for (const NodePlace& n : nodes) most = std::max(most, displacement_at(n, d, u).norm());
  return most;
}

/// The motion in words; of several bodies that do not move as one, body by body, those at rest left
/// out, each called by the mean of its nodes; of many the three that move most.
inline std::string describe_motion(const std::vector<NodePlace>& nodes, int d, const Vector& u) {
  const auto bodies = by_body(nodes);
  const RigidMotion all = nearest_rigid_motion(nodes, d, u);
  if (bodies.size() < 2 || all.misfit <= rigid_misfit) return describe_one(nodes, d, u);
  const Real most = largest_displacement(nodes, d, u);
  std::vector<const std::vector<NodePlace>*> moving;
  for (const auto& [number, body] : bodies)
    if (largest_displacement(body, d, u) > still * most) moving.push_back(&body);
  constexpr std::size_t named = 3;
  if (moving.size() > named)
    std::stable_sort(moving.begin(), moving.end(), [&](const auto* a, const auto* b) {
      return largest_displacement(*a, d, u) > largest_displacement(*b, d, u);
    });
  std::string text;
  for (std::size_t k = 0; k < std::min(named, moving.size()); ++k) {
    const Eigen::Vector3d centre = nearest_rigid_motion(*moving[k], d, u).c;
    text += (text.empty() ? "" : ", with ") + describe_one(*moving[k], d, u) +
            " of the body around " + components_of(centre, d, 1e-6 + centre.norm());
  }
  if (moving.size() > named) text += ", and " + std::to_string(moving.size() - named) + " more";
  return text;
}

}  // namespace frictioncg
