#include "assembly/mortar/sheets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace frictioncg::mortar {

namespace {

/// A step between two surfaces, over the size of the slave facet, from which they are two.
constexpr Real step = 0.02;
/// From facet to facet also over the distance: seen along two normals it is not quite the same.
constexpr Real much_farther = 0.25;

/// A cell with the plane of its master facet, seen along the normal of the slave facet.
struct Seen {
  Affine distance;
  Vec2 centre;
  Real size() const { return std::abs(distance(centre)); }
};

/// Cells of facets that share a vertex are of one sheet.
Groups joined_by_vertices(const Side& master, const std::vector<Cell>& cells) {
  Groups sheets(static_cast<Index>(cells.size()));
  std::map<Index, Index> first;  // cell at a vertex
  for (Index p = 0; p < static_cast<Index>(cells.size()); ++p)
    for (int v = 0; v < master.d; ++v)
      sheets.join(p, first.emplace(master.facet(cells[p].master).node[v], p).first->second);
  return sheets;
}

/// How far apart two cells' surfaces are between them.
Real step_between(const Seen& a, const Seen& b) {
  const Vec2 between = (a.centre + b.centre) / 2;
  return std::abs(a.distance(between) - b.distance(between));
}

}  // namespace

void keep_nearest_sheet(const Side& slave, Index facet, const Side& master,
                        const std::vector<Vec3>& X, std::vector<Cell>& cells) {
  const Index n = static_cast<Index>(cells.size());
  if (n < 2) return;
  Groups sheets = joined_by_vertices(master, cells);
  bool one = true;
  for (Index p = 1; p < n; ++p) one = one && sheets.of(p) == sheets.of(0);
  if (one) return;
  const Plane& base = slave.planes[facet];
  std::vector<Seen> seen;
  for (const Cell& c : cells)
    seen.push_back({project(slave.d, base, master.facet(c.master), X).distance, centroid(c.part)});
  for (Index p = 0; p < n; ++p)
    for (Index q = 0; q < p; ++q)
      if (step_between(seen[p], seen[q]) <= step * base.size) sheets.join(p, q);
  const auto nearer = [](const Seen& a, const Seen& b) { return a.size() < b.size(); };
  const Index nearest =
      static_cast<Index>(std::min_element(seen.begin(), seen.end(), nearer) - seen.begin());
  std::vector<Cell> kept;
  for (Index p = 0; p < n; ++p)
    if (sheets.of(p) == sheets.of(nearest)) kept.push_back(std::move(cells[p]));
  cells = std::move(kept);
}

void uncover_beyond_steps(const Side& slave, const Side& master, const std::vector<Vec3>& X,
                          std::vector<std::vector<Cell>>& cells) {
  const Vec2 corner[3] = {{0, 0}, {1, 0}, {0, 1}};
  constexpr Real none = -1;
  std::vector<std::array<Real, 3>> at(cells.size(), {none, none, none});  // distance at vertices
  std::map<Index, Real> nearest;
  for (Index f = 0; f < slave.facets(); ++f)
    for (int v = 0; v < slave.d && !cells[f].empty(); ++v) {
      const auto closer = [&](const Cell& a, const Cell& b) {
        return (centroid(a.part) - corner[v]).norm() < (centroid(b.part) - corner[v]).norm();
      };
      const Cell& cell = *std::min_element(cells[f].begin(), cells[f].end(), closer);
      const Projection p = project(slave.d, slave.planes[f], master.facet(cell.master), X);
      at[f][v] = std::abs(p.distance(corner[v]));
      Real& least = nearest.emplace(slave.facet(f).node[v], at[f][v]).first->second;
      least = std::min(least, at[f][v]);
    }
  for (Index f = 0; f < slave.facets(); ++f)
    for (int v = 0; v < slave.d; ++v) {
      if (at[f][v] == none) continue;
      const Real beyond = at[f][v] - nearest.at(slave.facet(f).node[v]);
      if (beyond > std::max(step * slave.planes[f].size, much_farther * at[f][v])) cells[f].clear();
    }
}

}  // namespace frictioncg::mortar
