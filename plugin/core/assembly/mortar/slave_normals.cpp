#include "assembly/mortar/slave_normals.h"

#include <algorithm>
#include <map>

#include "assembly/mortar/smooth_side.h"
#include "assembly/slippable.h"

namespace frictioncg::mortar {

namespace {

/// A node with the surfaces that meet there.
struct Meeting {
  Index fan = -1;  ///< the first of them
  bool several = false;
  PointNormal point;
  Vec3 sum = Vec3::Zero();  ///< of their normals, weighted
};
using Meetings = std::map<Index, Meeting>;

void add(Index fan, const FanNormal& found, Real measure, Meeting& at) {
  if (at.fan < 0) at.fan = fan, at.point.normal = found.normal;
  at.several = at.several || at.fan != fan;
  at.point.weight += measure;
  at.point.turn = std::max(at.point.turn, found.turn);
  at.sum += measure * found.normal;
  if (at.several) at.point.normal = at.sum.normalized();
}

Meetings meetings(const Nodes& nodes, const Side& slave, std::size_t p, const Owns& owns) {
  const SmoothSide smooth(slave, nodes.X, joints_that_go_on(slave));
  Meetings found;
  for (Index f = 0; f < slave.facets(); ++f)
    for (int v = 0; v < slave.d; ++v) {
      const Index i = slave.facet(f).node[v];
      if (!owns(p, f, i)) continue;
      Meeting& here = found[i];
      here.point.x = nodes.X[i];
      add(smooth.fan(f, v), smooth.at(f, v), slave.planes[f].measure, here);
    }
  return found;
}

bool any_curved(const Meetings& all) {
  return std::any_of(all.begin(), all.end(), [](const auto& m) { return m.second.point.turn > 0; });
}

/// Makes the motions of each body tangential by themselves: other bodies have other motions.
/// body: of each node; empty: all are one
void follow_motions(int d, const std::vector<Index>& body, Meetings& all) {
  std::map<Index, std::vector<Index>> of_body;
  for (const auto& [i, at] : all) of_body[body.empty() ? 0 : body[i]].push_back(i);
  for (const auto& [number, own] : of_body) {
    std::vector<PointNormal> points;
    for (Index i : own) points.push_back(all[i].point);
    follow_slippable_motions(d, points);
    for (std::size_t k = 0; k < own.size(); ++k) all[own[k]].point = points[k];
  }
}

}  // namespace

std::vector<Vec3> slave_normals(const Nodes& nodes, const std::vector<Side>& slaves,
                                const Options& options, const Owns& owns) {
  std::vector<Meetings> all;
  for (std::size_t p = 0; p < slaves.size(); ++p)
    all.push_back(meetings(nodes, slaves[p], p, owns));
  std::vector<Index> body;
  if (options.bodies && std::any_of(all.begin(), all.end(), any_curved)) body = options.bodies();
  std::vector<Vec3> normal(nodes.X.size(), Vec3::Zero());
  for (Meetings& found : all) {
    follow_motions(nodes.dimension, body, found);
    for (const auto& [i, at] : found) normal[i] = at.point.normal;
  }
  return normal;
}

}  // namespace frictioncg::mortar
