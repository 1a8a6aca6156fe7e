#include "assembly/mortar/self_contact.h"

#include "assembly/mortar/search.h"
#include "linear_algebra.h"

namespace frictioncg::mortar {

namespace {

/// Sizes are equal up to the first share, by which those of a mesh that is equally fine everywhere
/// may differ, from increment to increment the one way and the other; what tells directions, up to
/// the second.
constexpr Real as_fine = 0.1, equal = 1e-3;

/// The principal axes of a surface in the reference, as columns. A direction is that along which
/// the surface is skew; where it is so along all but one of them, the right hand tells the last.
/// Axes whose direction nothing tells are 0.
Eigen::Matrix3d own_axes(const Side& side, const OwnSurface& own) {
  Vector w(side.facets());
  Eigen::Matrix3Xd x(3, side.facets());
  for (Index f = 0; f < side.facets(); ++f) {
    w[f] = own.planes[f].measure;
    x.col(f) = centre_of(side.d, side.facet(f), own.X);
  }
  const Real measure = w.sum();
  x.colwise() -= Vec3(x * w / measure);
  const Eigenpairs spread = eigenpairs(x * w.asDiagonal() * x.transpose() / measure);
  Eigen::Matrix3d axes = spread.vectors;
  const Vec3 skewness = (axes.transpose() * x).array().cube().matrix() * w;
  std::vector<int> untold;
  bool distinct = true;
  for (int c = side.d == 2 ? 1 : 0; c < 3; ++c) {
    const Real size = std::sqrt(std::max<Real>(0, spread.values[c]));
    if (c > 0) distinct &= spread.values[c] - spread.values[c - 1] > equal * spread.values[c];
    if (!(std::abs(skewness[c]) > equal * measure * size * size * size)) untold.push_back(c);
    if (skewness[c] < 0) axes.col(c) *= -1;
  }
  if (side.d == 2) axes.col(0) = Vec3::UnitZ();
  if (!distinct) return Eigen::Matrix3d::Zero();
  if (untold.size() == 1)
    axes.col(untold[0]) = axes.col((untold[0] + 1) % 3).cross(axes.col((untold[0] + 2) % 3));
  else
    for (int c : untold) axes.col(c).setZero();
  return axes;
}

/// Facets of one surface that face each other, and what hangs together with them.
struct Encounter {
  std::vector<Index> facets;
  Eigen::Matrix3d directions = Eigen::Matrix3d::Zero();
};

/// One of the two sides of an encounter.
struct Half {
  std::vector<Index> facets;
  Vec3 place = Vec3::Zero();  ///< mean, in the reference
  Real size = 0;              ///< mean

  Half(const Encounter& all, const Side& side, const OwnSurface& own, const Vec3& outward) {
    for (Index f : all.facets) {
      if (side.planes[f].normal.dot(outward) <= -hardly) continue;
      facets.push_back(f);
      size += own.planes[f].size;
      place += centre_of(side.d, side.facet(f), own.X);
    }
    const Real count = static_cast<Real>(std::max<std::size_t>(1, facets.size()));
    size /= count;
    place /= count;
  }
  /// Along the axis, or where none tells the coordinate, along which they are furthest apart.
  bool before(const Half& o, const Eigen::Matrix3d& axes) const {
    if (std::abs(size - o.size) > as_fine * size) return size < o.size;
    for (const Vec3& way : {Vec3(axes.transpose() * (place - o.place)), Vec3(place - o.place)}) {
      int most = 2;
      for (int c : {1, 0})
        if (std::abs(way[c]) > (1 + equal) * std::abs(way[most])) most = c;
      if (std::abs(way[most]) > (place - o.place).norm() / 2) return way[most] < 0;
    }
    return true;
  }
};

/// How far a cell is from facet f [length].
Real distance_of(const Side& side, Index f, const Cell& cell, const std::vector<Vec3>& X) {
  const Projection p = project(side.d, side.planes[f], side.facet(cell.master), X);
  return std::abs(p.distance(centroid(cell.part)));
}

/// Of the facets that face their own body; nearest: nearest_bodies().
std::map<Index, Encounter> encounters(const Side& side, const Cover& cover,
                                      const std::vector<Index>& nearest,
                                      const std::vector<Vec3>& X) {
  const auto faces_own = [&](Index f) {
    return !cover.cells[f].empty() && nearest[f] == side.facet(f).body;
  };
  Groups groups(side.facets());
  std::map<Index, Index> first;  // facet at a vertex
  for (Index f = 0; f < side.facets(); ++f) {
    if (!faces_own(f)) continue;
    for (int v = 0; v < side.d; ++v)
      groups.join(f, first.emplace(side.facet(f).node[v], f).first->second);
    for (const Cell& cell : cover.cells[f])
      if (faces_own(cell.master)) groups.join(f, cell.master);
  }
  std::map<Index, Encounter> found;
  for (Index f = 0; f < side.facets(); ++f) {
    if (!faces_own(f)) continue;
    Encounter& encounter = found[groups.of(f)];
    encounter.facets.push_back(f);
    const Plane& plane = side.planes[f];
    for (const Cell& cell : cover.cells[f])
      encounter.directions += extent(cell.part) * plane.measure /
                              (distance_of(side, f, cell, X) + plane.size) * plane.normal *
                              plane.normal.transpose();
  }
  return found;
}

/// A body of several, and by what they are told apart: one key after the other, where they differ.
struct RankedBody {
  Index body;
  std::array<Real, 7> key;
};

void sort_by(std::vector<RankedBody>& bodies, std::size_t begin, std::size_t end, std::size_t level,
             const std::array<Real, 7>& differ) {
  if (end - begin < 2 || level == differ.size()) return;
  std::sort(
      bodies.begin() + Index(begin), bodies.begin() + Index(end),
      [level](const RankedBody& a, const RankedBody& b) { return a.key[level] < b.key[level]; });
  for (std::size_t k = begin + 1; k <= end; ++k)
    if (k == end || bodies[k].key[level] - bodies[k - 1].key[level] > differ[level]) {
      sort_by(bodies, begin, k, level + 1, differ);
      begin = k;
    }
}

/// The place of each body in an order of all: it is the slave of those that come before it.
std::map<Index, Index> ranks(const Side& side, const OwnSurface& own, const Eigen::Matrix3d& axes) {
  struct Mean {
    Real size = 0, count = 0;
    Vec3 place = Vec3::Zero();
  };
  std::map<Index, Mean> means;
  Eigen::AlignedBox3d box;
  for (Index f = 0; f < side.facets(); ++f) {
    Mean& mean = means[side.facet(f).body];
    const Vec3 centre = centre_of(side.d, side.facet(f), own.X);
    mean.size += own.planes[f].size;
    mean.place += centre;
    mean.count += 1;
    box.extend(centre);
  }
  std::vector<RankedBody> bodies;
  for (const auto& [body, mean] : means) {
    const Vec3 x = mean.place / mean.count, along = axes.transpose() * x;
    bodies.push_back(
        {body,
         {-std::log(mean.size / mean.count), along[2], along[1], along[0], x[0], x[1], x[2]}});
  }
  std::array<Real, 7> differ;
  differ.fill(equal * box.diagonal().norm());
  differ[0] = std::log(1 + as_fine);
  sort_by(bodies, 0, bodies.size(), 0, differ);
  std::map<Index, Index> rank;
  for (const RankedBody& b : bodies) rank.emplace(b.body, Index(rank.size()));
  return rank;
}

/// A facet that faces nothing joins the side from which the fewest facets part it, between two as
/// near the master: where the one side ends before the other, its last node is not on both.
/// decided: facets whose side is known
void spread(const Side& side, std::vector<Index> decided, std::vector<char>& is_slave) {
  std::vector<std::vector<Index>> beside(side.facets());
  for (const Joint& joint : side.joints)
    for (int k : {0, 1}) beside[joint.facet[k]].push_back(joint.facet[1 - k]);
  std::vector<char> known(side.facets(), 0);
  for (Index f : decided) known[f] = 1;
  std::stable_partition(decided.begin(), decided.end(), [&](Index f) { return !is_slave[f]; });
  for (std::size_t k = 0; k < decided.size(); ++k)
    for (Index f : beside[decided[k]]) {
      if (known[f]) continue;
      known[f] = 1;
      is_slave[f] = is_slave[decided[k]];
      decided.push_back(f);
    }
}

/// The body that each facet is nearest to, of those before it; of some as near the first in rank,
/// so that a facet over two is the slave of either.
std::vector<Index> nearest_bodies(const Side& side, const Cover& cover,
                                  const std::map<Index, Index>& rank, const std::vector<Vec3>& X) {
  std::vector<Index> body(side.facets(), -1);
  for (Index f = 0; f < side.facets(); ++f) {
    Real nearest = infinity;
    const Real as_near = equal * side.planes[f].size;
    for (const Cell& cell : cover.cells[f]) {
      const Index other = side.facet(cell.master).body;
      const Real away = distance_of(side, f, cell, X);
      const bool first = away < nearest - as_near ||
                         (away < nearest + as_near && rank.at(other) < rank.at(body[f]));
      if (first) nearest = away, body[f] = other;
    }
  }
  return body;
}

Roles roles_of(const Nodes& nodes, const Pair& pair, Real maxgap) {
  const Side side(nodes.dimension, pair.slave, nodes.X);
  const OwnSurface own(side, nodes, true);
  const Eigen::Matrix3d axes = own_axes(side, own);
  const Cover faced = cover(nodes, true, side, side, maxgap);
  const std::map<Index, Index> rank = ranks(side, own, axes);
  const std::vector<Index> nearest = nearest_bodies(side, faced, rank, nodes.X);
  std::set<std::pair<Index, Index>> sees;  // bodies, one the other
  for (Index f = 0; f < side.facets(); ++f)
    for (const Cell& cell : faced.cells[f])
      sees.emplace(side.facet(f).body, side.facet(cell.master).body);
  std::vector<char> is_slave(side.facets(), 0);
  std::vector<Index> decided;
  for (Index f = 0; f < side.facets(); ++f) {
    const Index body = side.facet(f).body;
    if (faced.cells[f].empty() || nearest[f] == body) continue;
    is_slave[f] = rank.at(body) > rank.at(nearest[f]) || sees.count({nearest[f], body}) == 0;
    decided.push_back(f);
  }
  for (const auto& [root, encounter] : encounters(side, faced, nearest, nodes.X)) {
    const Vec3 a = eigenpairs(encounter.directions).vectors.col(2);
    const Half one(encounter, side, own, a), other(encounter, side, own, -a);
    for (Index f : (one.before(other, axes) ? one : other).facets) is_slave[f] = 1;
    for (const Half* half : {&one, &other})
      decided.insert(decided.end(), half->facets.begin(), half->facets.end());
  }
  if (decided.empty()) return {};
  spread(side, decided, is_slave);
  Roles roles{std::move(is_slave), std::vector<std::pair<Index, std::set<Index>>>(rank.size())};
  for (const auto& [body, k] : rank) roles.faced[k].first = body;
  for (Index f = 0; f < side.facets(); ++f) {
    const Index body = side.facet(f).body;
    if (!roles.is_slave[f]) continue;
    for (const Cell& cell : faced.cells[f]) {
      const Index other = side.facet(cell.master).body;
      if (other == nearest[f] || rank.at(other) < rank.at(body))
        roles.faced[rank.at(body)].second.insert(other);
    }
  }
  return roles;
}

}  // namespace

bool touches_itself(const Pair& pair) {
  const std::vector<Facet>&slave = pair.slave.facets, &master = pair.master.facets;
  const auto same = [](const Facet& a, const Facet& b) { return a.node == b.node; };
  return !slave.empty() &&
         std::equal(slave.begin(), slave.end(), master.begin(), master.end(), same);
}

bool OwnSurface::is_through_body(const Side& side, Index f, const Facet& m, const Vec2& xi) const {
  // before a deformation what is behind may lie so many facets aside
  constexpr Real aside = 2;
  constexpr Real at_corner = 0.9;  // of the thickness: the end of a convex body is no nearer
  const Facet& own = side.facet(f);
  if (own.body != m.body || std::isinf(std::min(own.thickness, m.thickness))) return false;
  const Projection p = project(side.d, planes[f], m, X);
  const Real depth = -p.distance(xi), at_middle = -p.distance(centroid(reference_facet(side.d)));
  if (!p.inverts || depth <= 0 || p.at(xi).head(side.d).minCoeff() < -aside) return false;
  return depth > m.thickness / 2 || at_middle > at_corner * own.thickness;
}

bool OwnSurface::excludes(const Side& side, Index f, const Facet& m, const Vec2& xi, Real distance,
                          Real deepest) const {
  const Facet& own = side.facet(f);
  if (touches_itself)
    for (int v = 0; v < side.d; ++v)
      if (std::count(m.node.begin(), m.node.begin() + side.d, own.node[v]) > 0) return true;
  if (distance >= 0) return false;
  return (touches_itself && -distance > deepest) || is_through_body(side, f, m, xi);
}

void find_roles(const Nodes& nodes, const std::vector<Pair>& pairs, Real maxgap,
                std::vector<Roles>& decided) {
  decided.resize(pairs.size());
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    if (!touches_itself(pairs[p])) continue;
    Roles now = roles_of(nodes, pairs[p], maxgap);
    if (decided[p].faced.empty()) {
      decided[p] = std::move(now);
      continue;
    }
    std::map<Index, std::set<Index>> more(now.faced.begin(), now.faced.end());
    for (auto& [body, masters] : decided[p].faced)
      if (!masters.empty()) masters.merge(more[body]);
  }
}

std::vector<Pair> parted(const std::vector<Pair>& given, const std::vector<Roles>& roles,
                         bool moves) {
  std::vector<Pair> pairs;
  for (std::size_t p = 0; p < given.size(); ++p) {
    const Surface &slave = given[p].slave, &master = given[p].master;
    const bool itself = touches_itself(given[p]);
    const auto add = [&](const Surface& slaves) -> Pair& {
      pairs.push_back({slaves, {master.quadratic, master.labels, {}}, itself, Index(p)});
      return pairs.back();
    };
    if (!itself) {
      add(slave).master = master;
      continue;
    }
    if (roles[p].faced.empty()) {
      if (!moves)
        refuse(labels_of(slave),
               " does not face itself: no facet lies opposite another one, along its normal; name "
               "another master, or no contact");
      add(slave);
      continue;
    }
    std::map<Index, std::size_t> own;                    // the pair of a body's slaves
    std::map<Index, std::vector<std::size_t>> faced_by;  // those of which it is before the slaves
    for (const auto& [body, masters] : roles[p].faced) {
      if (masters.empty()) continue;
      own[body] = pairs.size();
      for (Index other : masters) faced_by[other].push_back(pairs.size());
      add({slave.quadratic, slave.labels, {}});
    }
    for (std::size_t f = 0; f < slave.facets.size(); ++f) {
      const Index body = slave.facets[f].body;
      if (roles[p].is_slave[f]) {
        pairs[own.at(body)].slave.facets.push_back(slave.facets[f]);
        continue;
      }
      for (std::size_t k : faced_by[body]) {
        Facet facet = master.facets[f];
        facet.one_body = own.count(body) > 0 && own[body] == k;
        pairs[k].master.facets.push_back(facet);
      }
    }
  }
  return pairs;
}

}  // namespace frictioncg::mortar
