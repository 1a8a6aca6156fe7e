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
      if (side.planes[f].normal.dot(outward) <= -facing) continue;
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

std::map<Index, Encounter> encounters(const Side& side, const Cover& cover,
                                      const std::vector<Vec3>& X) {
  Groups groups(side.facets());
  std::map<Index, Index> first;  // facet at a vertex
  for (Index f = 0; f < side.facets(); ++f) {
    if (cover.cells[f].empty()) continue;
    for (int v = 0; v < side.d; ++v)
      groups.join(f, first.emplace(side.facet(f).node[v], f).first->second);
    for (const Cell& cell : cover.cells[f]) groups.join(f, cell.master);
  }
  std::map<Index, Encounter> found;
  for (Index f = 0; f < side.facets(); ++f) {
    if (cover.cells[f].empty()) continue;
    Encounter& encounter = found[groups.of(f)];
    encounter.facets.push_back(f);
    const Plane& plane = side.planes[f];
    for (const Cell& cell : cover.cells[f]) {
      const Projection p = project(side.d, plane, side.facet(cell.master), X);
      const Real away = std::abs(p.distance(centroid(cell.part)));
      encounter.directions += extent(cell.part) * plane.measure / (away + plane.size) *
                              plane.normal * plane.normal.transpose();
    }
  }
  return found;
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

/// Which facets are slaves; none where nothing faces itself.
std::vector<char> slaves_of(const Nodes& nodes, const Pair& pair, Real maxgap) {
  const Side side(nodes.dimension, pair.slave, nodes.X);
  const OwnSurface own(side, nodes, true);
  const Eigen::Matrix3d axes = own_axes(side, own);
  std::vector<char> is_slave(side.facets(), 0);
  std::vector<Index> decided;
  const Cover faced = cover(nodes, pair, side, side, maxgap);
  for (const auto& [root, encounter] : encounters(side, faced, nodes.X)) {
    const Vec3 a = eigenpairs(encounter.directions).vectors.col(2);
    const Half one(encounter, side, own, a), other(encounter, side, own, -a);
    for (Index f : (one.before(other, axes) ? one : other).facets) is_slave[f] = 1;
    decided.insert(decided.end(), encounter.facets.begin(), encounter.facets.end());
  }
  spread(side, decided, is_slave);
  return decided.empty() ? std::vector<char>() : is_slave;
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
  if (side.facet(f).body != m.body || !std::isfinite(m.thickness)) return false;
  const Projection p = project(side.d, planes[f], m, X);
  return p.inverts && p.at(xi).head(side.d).minCoeff() >= -aside &&
         -p.distance(xi) > m.thickness / 2;
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

void find_slaves(const Nodes& nodes, const std::vector<Pair>& pairs, Real maxgap,
                 SlaveFacets& decided) {
  decided.resize(pairs.size());
  for (std::size_t p = 0; p < pairs.size(); ++p)
    if (decided[p].empty() && touches_itself(pairs[p]))
      decided[p] = slaves_of(nodes, pairs[p], maxgap);
}

std::vector<Pair> parted(std::vector<Pair> pairs, const SlaveFacets& slaves, bool moves) {
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    Pair& pair = pairs[p];
    if (!touches_itself(pair)) continue;
    if (slaves[p].empty() && !moves)
      refuse(labels_of(pair.slave),
             " does not face itself: no facet lies opposite another one, along its normal; name "
             "another master, or no contact");
    std::vector<Facet> slave, master;
    for (std::size_t f = 0; f < pair.slave.facets.size(); ++f)
      if (slaves[p].empty() || slaves[p][f])
        slave.push_back(pair.slave.facets[f]);
      else
        master.push_back(pair.master.facets[f]);
    pair.slave.facets = std::move(slave);
    pair.master.facets = std::move(master);
  }
  return pairs;
}

}  // namespace frictioncg::mortar
