#include "statics/nearest_motion.h"

#include "linear_algebra.h"

namespace frictioncg {

namespace {

/// u at a node; components beyond d are 0.
Vec3 displacement_at(const NodePlace& n, int d, const Vector& u) {
  Vec3 at = Vec3::Zero();
  for (int k = 0; k < d; ++k) at[k] = u[n.dof[k]];
  return at;
}

/// Of nodes of mass 1, about a point.
Eigen::Matrix3d inertia_of(const std::vector<NodePlace>& nodes, const Vec3& about) {
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (const NodePlace& n : nodes) {
    const Vec3 arm = n.x - about;
    inertia += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
  }
  return inertia;
}

constexpr Real rigid_misfit = 1e-3;  ///< up to which a motion is called rigid

/// A rotation about a centre as many times the extent of the body away is a translation: rounding,
/// amplified by a nearly singular A, turns every translation by so much.
constexpr Real far_away = 2000;

/// The motion of one body in words; where a part of the body moves, the node that moves most.
std::string describe_one(const std::vector<NodePlace>& nodes, int d, const Vector& u) {
  const RigidMotion m = nearest_rigid_motion(nodes, d, u);
  if (m.misfit <= rigid_misfit) return describe(m, d);
  const auto less = [&](const NodePlace& a, const NodePlace& b) {
    return displacement_at(a, d, u).norm() < displacement_at(b, d, u).norm();
  };
  const NodePlace& most = *std::max_element(nodes.begin(), nodes.end(), less);
  return "a motion of a part of the body, most at " +
         components_of(most.x, d, 1e-6 + most.x.norm()) + ", along " +
         components_of(displacement_at(most, d, u).normalized(), d, 1);
}

/// Rotation over strain, from which on a body hardly strains: loads that turn it far strain it.
constexpr Real stiff_turn = 8;
/// The same of a jam, which strains the body: 6 to 10 where its force is 2 to 15 times too large.
constexpr Real stiff_jam = 3;
/// Over its arm, the mean lever of the pressures on a body that is round: 0.2 with 16 facets, half
/// a facet off. Blocks have 0.4.
constexpr Real round_lever = 0.3;

/// visit(dof, values): a row of the modes for each component of each node.
template <class Visit>
void for_each_row(const std::vector<NodePlace>& nodes, int d, const Extent& extent,
                  const Visit& visit) {
  const RigidGenerators generators(d, extent.mean, extent.radius > 0 ? extent.radius : 1);
  for (const NodePlace& p : nodes) {
    const RigidGenerators::Fields w = generators.at(p.x);
    for (int k = 0; k < d; ++k) visit(p.dof[k], w.row(k));
  }
}

}  // namespace

Eigen::MatrixXd rigid_modes(const std::vector<NodePlace>& nodes, int d, Index n,
                            const Extent& extent) {
  Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(n, rigid_components(d));
  for_each_row(nodes, d, extent, [&](Index dof, const auto& w) { modes.row(dof) = w; });
  return modes;
}

Eigen::MatrixXd rigid_modes(const std::vector<NodePlace>& nodes, int d, Index n) {
  return rigid_modes(nodes, d, n, extent_of(nodes));
}

Real slenderness(const std::vector<NodePlace>& nodes, int d) {
  const Eigen::Matrix3d inertia = inertia_of(nodes, extent_of(nodes).mean);
  const Eigen::Matrix3d moments = inertia.trace() / 2 * Eigen::Matrix3d::Identity() - inertia;
  const Vector extent = eigenpairs(moments.topLeftCorner(d, d)).values;
  return extent[0] > 0 ? std::sqrt(extent.tail(1)[0] / extent[0]) : 1;
}

Index count_bodies(const std::vector<NodePlace>& nodes) {
  Index count = 0;
  for (const NodePlace& n : nodes) count = std::max(count, n.body + 1);
  return count;
}

std::map<Index, std::vector<NodePlace>> by_body(const std::vector<NodePlace>& nodes) {
  std::map<Index, std::vector<NodePlace>> bodies;
  for (const NodePlace& p : nodes) bodies[p.body].push_back(p);
  return bodies;
}

Matrix body_modes(const std::vector<std::vector<NodePlace>>& bodies,
                  const std::vector<Extent>& extents, int d, Index n) {
  const Index each = rigid_components(d);
  EntryList entries;
  for (std::size_t k = 0; k < bodies.size(); ++k)
    for_each_row(bodies[k], d, extents[k], [&](Index dof, const auto& w) {
      for (Index j = 0; j < each; ++j)
        if (w[j] != 0) entries.emplace_back(dof, each * static_cast<Index>(k) + j, w[j]);
    });
  return sparse(n, each * static_cast<Index>(bodies.size()), entries);
}

Matrix body_modes(const std::vector<NodePlace>& nodes, int d, Index n) {
  std::vector<std::vector<NodePlace>> bodies;
  std::vector<Extent> extents;
  for (const auto& [number, body] : by_body(nodes)) {
    bodies.push_back(body);
    extents.push_back(extent_of(body));
  }
  return body_modes(bodies, extents, d, n);
}

RigidMotion nearest_rigid_motion(const std::vector<NodePlace>& nodes, int d, const Vector& u) {
  RigidMotion motion;
  if (nodes.empty()) return motion;
  const Extent extent = extent_of(nodes);
  motion.c = extent.mean;
  motion.extent = extent.radius;
  Vec3 moment = Vec3::Zero();
  for (const NodePlace& n : nodes) {
    const Vec3 v = displacement_at(n, d, u);
    motion.a += v / static_cast<Real>(nodes.size());
    moment += (n.x - motion.c).cross(v);
  }
  motion.w = least_squares(inertia_of(nodes, motion.c), moment);
  for (const NodePlace& n : nodes) {
    const Vec3 v = displacement_at(n, d, u);
    motion.misfit = std::max(motion.misfit, (v - motion.a - motion.w.cross(n.x - motion.c)).norm());
  }
  const Real most = largest_displacement(nodes, d, u);
  if (most > 0) motion.misfit /= most;
  return motion;
}

std::string components_of(const Vec3& v, int d, Real unit) {
  std::ostringstream s;
  s.precision(4);
  for (int k = 0; k < d; ++k) s << (k ? ", " : "(") << (std::abs(v[k]) < 1e-6 * unit ? 0 : v[k]);
  s << ")";
  return s.str();
}

std::string describe(const RigidMotion& m, int d) {
  const Real turn = m.w.norm();
  if (far_away * turn * m.extent <= m.a.norm())
    return m.a.norm() > 0
               ? "a translation along " + components_of(m.a.normalized(), d, 1e6 / far_away)
               : "no motion";
  const Vec3 axis = m.w / turn;
  const Vec3 centre = m.c + m.w.cross(m.a) / (turn * turn);
  const std::string about = components_of(centre, d, m.extent + centre.norm());
  if (d == 2)
    return std::string("a rotation, ") + (m.w[2] > 0 ? "counter-clockwise" : "clockwise") +
           ", about " + about;
  std::string text = "a rotation about the axis " + components_of(axis, d, 1) + " through " + about;
  const Real along = m.a.dot(axis);
  if (std::abs(along) > at_rest * turn * m.extent) text += ", with a translation along it";
  return text;
}

Real largest_displacement(const std::vector<NodePlace>& nodes, int d, const Vector& u) {
  Real most = 0;
  for (const NodePlace& n : nodes) most = std::max(most, displacement_at(n, d, u).norm());
  return most;
}

std::string describe_motion(const std::vector<NodePlace>& nodes, int d, const Vector& u) {
  const auto bodies = by_body(nodes);
  const RigidMotion all = nearest_rigid_motion(nodes, d, u);
  if (bodies.size() < 2 || all.misfit <= rigid_misfit) return describe_one(nodes, d, u);
  const Real most = largest_displacement(nodes, d, u);
  std::vector<const std::vector<NodePlace>*> moving;
  for (const auto& [number, body] : bodies)
    if (largest_displacement(body, d, u) > at_rest * most) moving.push_back(&body);
  constexpr std::size_t named = 3;
  if (moving.size() > named)
    std::stable_sort(moving.begin(), moving.end(), [&](const auto* a, const auto* b) {
      return largest_displacement(*a, d, u) > largest_displacement(*b, d, u);
    });
  std::string text;
  for (std::size_t k = 0; k < std::min(named, moving.size()); ++k) {
    const Vec3 centre = nearest_rigid_motion(*moving[k], d, u).c;
    text += (text.empty() ? "" : ", with ") + describe_one(*moving[k], d, u) +
            " of the body around " + components_of(centre, d, 1e-6 + centre.norm());
  }
  if (moving.size() > named) text += ", and " + std::to_string(moving.size() - named) + " more";
  return text;
}

std::vector<LargeTurn> large_turns(const std::vector<NodePlace>& nodes, int d, const Vector& u) {
  std::vector<LargeTurn> turns;
  for (const auto& [number, body] : by_body(nodes)) {
    const RigidMotion motion = nearest_rigid_motion(body, d, u);
    const Real turn = motion.w.norm();
    if (!(turn > jamming_turn)) continue;
    const Real strain = motion.misfit * largest_displacement(body, d, u) / motion.extent;
    const bool large = turn > small_turn && turn > stiff_turn * strain;
    if (large || turn > stiff_jam * strain) turns.push_back({number, motion, strain, large});
  }
  return turns;
}

Real least_gyration(const std::vector<NodePlace>& nodes, int d) {
  Real least = infinity;
  for (const auto& [number, body] : by_body(nodes)) {
    const Eigen::Matrix3d inertia = inertia_of(body, extent_of(body).mean);
    const Real about_axis = d == 2 ? inertia(2, 2) : eigenpairs(inertia).values[0];
    least = std::min(least, std::sqrt(std::max<Real>(0, about_axis) / Real(body.size())));
  }
  return least;
}

DenseMatrix turning(const std::vector<Vector>& motions, const std::vector<NodePlace>& body, int d,
                    const Vec3& axis) {
  // over the largest displacement of the motion; next to a weak spring, A mixes 1e-5 into others
  constexpr Real none = 1e-4;
  const Index k = static_cast<Index>(motions.size());
  DenseMatrix turns = DenseMatrix::Zero(3, k);
  for (Index j = 0; j < k; ++j) {
    const RigidMotion m = nearest_rigid_motion(body, d, motions[j]);
    if (m.w.norm() * m.extent > none * motions[j].lpNorm<Eigen::Infinity>()) turns.col(j) = m.w;
  }
  if (turns.isZero(0)) return DenseMatrix(k, 0);
  const DenseMatrix first = least_squares(turns, axis, none),
                    others = null_space(turns, none * turns.norm());
  if (!((turns * first - axis).norm() < 0.5)) return DenseMatrix(k, 0);
  DenseMatrix all(k, 1 + others.cols());
  all << first, others;
  return all;
}

void StandAgainst::add(const Vector& against) {
  const DenseMatrix product = against * against.transpose();
  sums_.head(product.size()) += product.reshaped();
}

Real StandAgainst::share() const {
  const Index k = static_cast<Index>(std::lround(std::sqrt(Real(sums_.size() - 1)))), rest = k - 1;
  const DenseMatrix G = sums_.head(k * k).reshaped(k, k);
  Real left = G(0, 0);
  if (rest > 0) {
    const Vector along = G.col(0).tail(rest);
    left -= along.dot(Vector(least_squares(G.bottomRightCorner(rest, rest), along)));
  }
  const Real way = sums_.tail(1)[0];
  return way > 0 ? std::sqrt(std::max<Real>(left, 0) / way) : 0;
}

bool StandAgainst::holds(Real turn) const {
  constexpr Real clearly = 0.2;
  return share() > std::min(turn / 2, clearly);
}

void StandOnEdge::add(const RigidMotion& turn, const Vec3& x, const Vec3& normal, Real pressure,
                      Real limit) {
  const Vec3 axis = turn.w.normalized(), arm = x - turn.c, across = axis.cross(arm);
  const Vec3 e = axis.unitOrthogonal(), force = pressure * normal;
  const auto angle = [&](const Vec3& v) { return std::atan2(axis.cross(e).dot(v), e.dot(v)); };
  // a normal nearly along the axis has none
  const Real pointing =
      axis.cross(normal).norm() < 0.2 ? std::numeric_limits<Real>::quiet_NaN() : angle(normal);
  const Real moment = across.dot(force), change = turn.w.cross(across).dot(force);
  nodes_.push_back({angle(arm), pointing,
                    Moments{moment, change, std::abs(moment), limit * across.norm(),
                            across.norm() * std::abs(pressure)}});
}

/// By which share of a turn of node k about the axis the normal there turns, from the neighbours on
/// either side; 0 where there are none.
Real StandOnEdge::turn_of_normals(std::size_t k) const {
  constexpr Real near = 0.01, far = 0.8;  // closer ones tell errors, others lie on another surface
  const std::size_t count = nodes_.size();
  const auto between = [](Real from, Real to) { return std::remainder(to - from, 2 * M_PI); };
  Real turn = 0, sides = 0;
  for (const std::size_t step : {std::size_t(1), count - 1})
    for (std::size_t j = (k + step) % count; j != k; j = (j + step) % count) {
      const Real way = between(nodes_[k].place, nodes_[j].place);
      if (std::abs(way) < near) continue;
      const Real bend = between(nodes_[k].normal, nodes_[j].normal);
      if (std::abs(way) < far && std::abs(bend) < far) turn += bend / way, sides += 1;
      break;
    }
  return sides > 0 ? turn / sides : 0;
}

void StandOnEdge::sum(const System& system) {
  std::sort(nodes_.begin(), nodes_.end(),
            [](const Node& a, const Node& b) { return a.place < b.place; });
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    Moments& moments = nodes_[k].moments;
    moments[1] *= 1 - turn_of_normals(k);
    sums_ += moments;
  }
  system.sum(sums_.data(), Index(sums_.size()));
}

Real StandOnEdge::share() const {
  const Real moment = std::abs(sums_[0]), change = std::abs(sums_[1]), most = sums_[2] + sums_[3];
  const bool is_round = sums_[2] < round_lever * sums_[4];
  const bool rubs = sums_[3] > 0;
  return is_round && rubs ? std::min(moment, change) / most : 0;
}

std::string describe(const LargeTurn& turn, int d, Hold hold) {
  std::ostringstream s;
  s.precision(3);
  s << "the body around " << components_of(turn.motion.c, d, 1e-6 + turn.motion.c.norm())
    << " has turned by " << turn.motion.w.norm() << " radians, " << describe(turn.motion, d)
    << ", and is strained by no more than " << turn.strain;
  switch (hold) {
    case Hold::jams:
      s << ": contact held it where it was, and no longer where it has come. It jams: a linear "
           "rotation by theta makes it larger by theta^2/2, and its forces grow with that";
      break;
    case Hold::rolls:
      s << ": the pressures that held it where it was do not where it has come. It rolls on to an "
           "edge of the mesh, or tips: a vertex where a round body touches, and facets small "
           "beside mu, leave that out, and `at` follows it";
      break;
    default:
      s << ": small rotations cannot mean that, and nothing holds it but the error of the normals, "
           "the couple of friction and a gap, or a contact on which it rolls";
  }
  return s.str();
}

}  // namespace frictioncg
