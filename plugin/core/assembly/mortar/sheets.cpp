#include "assembly/mortar/sheets.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace frictioncg::mortar {

namespace {

/// A step between two surfaces, over the size of the slave facet, from which they are two.
constexpr Real step = 0.02;

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

}  // namespace frictioncg::mortar
