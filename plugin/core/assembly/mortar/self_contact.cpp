#include "assembly/mortar/self_contact.h"

#include <algorithm>
#include <map>

#include "assembly/mortar/search.h"
#include "assembly/mortar/slip.h"
#include "assembly/mortar/validation.h"
#include "linear_algebra.h"

namespace frictioncg::mortar {

namespace {

/// Sizes and places are equal up to this share.
constexpr Real equal = 1e-3;

/// Facets of one surface that face each other, and what hangs together with them.
struct Meeting {
  std::vector<Index> facets;
  Eigen::Matrix3d directions = Eigen::Matrix3d::Zero();
};

/// One of the two sides of a meeting.
struct Half {
  std::vector<Index> facets;
  Vec3 place = Vec3::Zero();  ///< mean, in the reference
  Real size = 0;              ///< mean

  Half(const Meeting& all, const Side& side, const OwnSurface& own, const Vec3& outward) {
    for (Index f : all.facets) {
      if (side.planes[f].normal.dot(outward) <= -facing) continue;
      facets.push_back(f);
      size += own.planes[f].size;
      for (int v = 0; v < side.d; ++v) place += own.X[side.facet(f).node[v]] / side.d;
    }
    const Real count = static_cast<Real>(std::max<std::size_t>(1, facets.size()));
    size /= count;
    place /= count;
  }
  bool before(const Half& o) const {
    if (std::abs(size - o.size) > equal * size) return size < o.size;
    const Real apart = equal * (place - o.place).norm();
    for (int c = 0; c < 3; ++c)
      if (std::abs(place[c] - o.place[c]) > apart) return place[c] < o.place[c];
    return true;
  }
};

std::vector<Meeting> meetings(const Side& side, const Cover& cover, const std::vector<Vec3>& X) {
  Groups groups(side.facets());
  std::map<Index, Index> first;  // facet at a vertex
  for (Index f = 0; f < side.facets(); ++f) {
    if (cover.cells[f].empty()) continue;
    for (int v = 0; v < side.d; ++v)
      groups.join(f, first.emplace(side.facet(f).node[v], f).first->second);
    for (const Cell& cell : cover.cells[f]) groups.join(f, cell.master);
  }
  std::map<Index, Meeting> found;
  for (Index f = 0; f < side.facets(); ++f) {
    if (cover.cells[f].empty()) continue;
    Meeting& meeting = found[groups.of(f)];
    meeting.facets.push_back(f);
    const Plane& plane = side.planes[f];
    for (const Cell& cell : cover.cells[f]) {
      const Projection p = project(side.d, plane, side.facet(cell.master), X);
      const Real away = std::abs(p.distance(centroid(cell.part)));
      meeting.directions += extent(cell.part) * plane.measure / (away + plane.size) * plane.normal *
                            plane.normal.transpose();
    }
  }
  std::vector<Meeting> all;
  for (auto& [root, meeting] : found) all.push_back(std::move(meeting));
  return all;
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
  const OwnSurface own(side, nodes.X, nodes.reference);
  std::vector<char> is_slave(side.facets(), 0);
  std::vector<Index> decided;
  for (const Meeting& meeting : meetings(side, cover(side, side, nodes.X, maxgap, &own), nodes.X)) {
    const Vec3 a = eigenpairs(meeting.directions).vectors.col(2);
    const Half one(meeting, side, own, a), other(meeting, side, own, -a);
    for (Index f : (one.before(other) ? one : other).facets) is_slave[f] = 1;
    decided.insert(decided.end(), meeting.facets.begin(), meeting.facets.end());
  }
  spread(side, decided, is_slave);
  return decided.empty() ? std::vector<char>() : is_slave;
}

/// The same where the increment began.
std::vector<char> slaves_before(const Nodes& nodes, const Pair& pair, Real maxgap) {
  if (nodes.before.empty()) return {};
  const int d = nodes.dimension;
  Nodes then = nodes;
  then.X = straightened(d, {pair}, nodes.before);
  return slaves_of(then, carried(d, {pair}, nodes.X, then.X)[0], maxgap);
}

void part(const std::vector<char>& is_slave, Pair& pair) {
  const std::vector<Facet> slave = pair.slave.facets, master = pair.master.facets;
  pair.slave.facets.clear();
  pair.master.facets.clear();
  for (std::size_t f = 0; f < slave.size(); ++f)
    if (is_slave[f])
      pair.slave.facets.push_back(slave[f]);
    else
      pair.master.facets.push_back(master[f]);
}

}  // namespace

bool OwnSurface::excludes(const Side& side, Index f, const Facet& m, const Vec2& xi, Real distance,
                          Real deepest) const {
  const Facet& own = side.facet(f);
  for (int v = 0; v < side.d; ++v)
    if (std::count(m.node.begin(), m.node.begin() + side.d, own.node[v]) > 0) return true;
  if (distance >= 0) return false;
  if (-distance > deepest) return true;
  const Projection p = project(side.d, planes[f], m, X);
  return p.inverts && p.distance(xi) < 0 && p.at(xi).head(side.d).minCoeff() >= 0;
}

bool touches_itself(const Pair& pair) {
  const std::vector<Facet>&slave = pair.slave.facets, &master = pair.master.facets;
  const auto same = [](const Facet& a, const Facet& b) { return a.node == b.node; };
  return !slave.empty() &&
         std::equal(slave.begin(), slave.end(), master.begin(), master.end(), same);
}

Cover cover(const Nodes& nodes, const Pair& given, const Side& slave, const Side& master,
            Real maxgap, const Earlier* earlier) {
  if (!touches_itself(given)) return cover(slave, master, nodes.X, maxgap, nullptr, earlier);
  const OwnSurface own(slave, nodes.X, nodes.reference);
  return cover(slave, master, nodes.X, maxgap, &own, earlier);
}

std::vector<Pair> parted(const Nodes& nodes, std::vector<Pair> pairs, Real maxgap) {
  for (Pair& pair : pairs) {
    if (!touches_itself(pair)) continue;
    std::vector<char> is_slave = slaves_before(nodes, pair, maxgap);
    if (is_slave.empty()) is_slave = slaves_of(nodes, pair, maxgap);
    if (is_slave.empty() && nodes.reference.empty())
      throw IllegalInput(labels_of(pair.slave) +
                         " does not face itself: no facet lies opposite another one, along its "
                         "normal; name another master, or no contact");
    if (is_slave.empty()) is_slave.assign(pair.slave.facets.size(), 1);
    part(is_slave, pair);
  }
  return pairs;
}

}  // namespace frictioncg::mortar
