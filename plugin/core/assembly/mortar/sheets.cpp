#include "assembly/mortar/sheets.h"

namespace frictioncg::mortar {

namespace {

/// Two surfaces are apart where the step between them is above this share of the slave facet's
/// size.
constexpr Real step = 0.02;
/// From facet to facet, the step is to be above this share of the distance, too: seen along two
/// normals, one distance is not quite the same.
constexpr Real much_farther = 0.25;

/// A cell with the plane of its master facet, seen along the normal of the slave facet.
struct Seen {
  Affine distance;
  Vec2 centre;
  Real size() const { return std::abs(distance(centre)); }
};

/// Facets that share a vertex are of one sheet.
Groups joined_by_vertices(const Side& master, const std::vector<Index>& facets) {
  Groups sheets(static_cast<Index>(facets.size()));
  std::map<Index, Index> first;  // facet at a vertex
  for (Index p = 0; p < static_cast<Index>(facets.size()); ++p)
    for (int v = 0; v < master.d; ++v)
      sheets.join(p, first.emplace(master.facet(facets[p]).node[v], p).first->second);
  return sheets;
}

/// How far apart two cells' surfaces are between them.
Real step_between(const Seen& a, const Seen& b) {
  const Vec2 between = (a.centre + b.centre) / 2;
  return std::abs(a.distance(between) - b.distance(between));
}

/// Whether each facet around a vertex faces a sheet that lies beyond a step, or faces the other way
/// than the nearest one: at the equator of a roller between two flats a mean of both would lie in
/// the node. Planes that meet at an angle also differ in distance, the more the farther their cells
/// are from the vertex: on one sheet, of all that these facets face, that is no step.
std::vector<bool> beyond_a_step(const std::vector<FacedAtVertex>& around, const Side& slave,
                                const Side& master, const std::vector<std::vector<Cell>>& cells) {
  const auto nearer = [](const auto& a, const auto& b) { return a.distance < b.distance; };
  const auto nearest = std::min_element(around.begin(), around.end(), nearer);
  std::vector<bool> beyond;
  for (const FacedAtVertex& f : around) {
    const bool other_way =
        master.planes[f.master].normal.dot(master.planes[nearest->master].normal) < 0;
    beyond.push_back(
        other_way ||
        f.distance - nearest->distance >
            std::max(step * slave.planes[f.facet].size, much_farther * std::abs(f.distance)));
  }
  if (std::find(beyond.begin(), beyond.end(), true) == beyond.end()) return beyond;
  std::vector<Index> masters;
  for (const FacedAtVertex& f : around) masters.push_back(f.master);
  for (const FacedAtVertex& f : around)
    for (const Cell& cell : cells[f.facet]) masters.push_back(cell.master);
  Groups sheets = joined_by_vertices(master, masters);
  for (Index p = 0; p < static_cast<Index>(around.size()); ++p)
    beyond[p] =
        beyond[p] && sheets.of(p) != sheets.of(static_cast<Index>(nearest - around.begin()));
  return beyond;
}

}  // namespace

FacedAtVertex faced_at_vertex(int v, const Side& slave, Index facet, const Side& master,
                              const std::vector<Vec3>& X, const std::vector<Cell>& cells) {
  const Vec2 corner = reference_vertex(v);
  const auto closer = [&](const Cell& a, const Cell& b) {
    return (centroid(a.part) - corner).norm() < (centroid(b.part) - corner).norm();
  };
  const Index nearest = std::min_element(cells.begin(), cells.end(), closer)->master;
  return {facet, nearest,
          project(slave.d, slave.planes[facet], master.facet(nearest), X).distance(corner)};
}

void keep_nearest_sheet(const Side& master, Real size,
                        const std::function<Affine(const Cell&)>& distance,
                        std::vector<Cell>& cells) {
  const Index n = static_cast<Index>(cells.size());
  if (n < 2) return;
  std::vector<Index> masters;
  for (const Cell& cell : cells) masters.push_back(cell.master);
  Groups sheets = joined_by_vertices(master, masters);
  bool one = true;
  for (Index p = 1; p < n; ++p) one = one && sheets.of(p) == sheets.of(0);
  if (one) return;
  std::vector<Seen> seen;
  for (const Cell& c : cells) seen.push_back({distance(c), centroid(c.part)});
  for (Index p = 0; p < n; ++p)
    for (Index q = 0; q < p; ++q)
      if (step_between(seen[p], seen[q]) <= step * size) sheets.join(p, q);
  const auto nearer = [](const Seen& a, const Seen& b) { return a.size() < b.size(); };
  const Index nearest =
      static_cast<Index>(std::min_element(seen.begin(), seen.end(), nearer) - seen.begin());
  std::vector<Cell> kept;
  for (Index p = 0; p < n; ++p)
    if (sheets.of(p) == sheets.of(nearest)) kept.push_back(std::move(cells[p]));
  cells = std::move(kept);
}

std::set<Corner> beyond_steps(const Side& slave, const Side& master, const std::vector<Vec3>& X,
                              const std::vector<std::vector<Cell>>& cells) {
  std::map<Index, std::vector<FacedAtVertex>> at;  // per vertex of the slave
  for (Index f = 0; f < slave.facets(); ++f)
    for (int v = 0; v < slave.d && !cells[f].empty(); ++v)
      at[slave.facet(f).node[v]].push_back(faced_at_vertex(v, slave, f, master, X, cells[f]));
  std::set<Corner> beyond;
  for (const auto& [vertex, around] : at) {
    const std::vector<bool> is_beyond = beyond_a_step(around, slave, master, cells);
    for (std::size_t k = 0; k < around.size(); ++k)
      if (is_beyond[k]) beyond.emplace(around[k].facet, vertex);
  }
  return beyond;
}

}  // namespace frictioncg::mortar
