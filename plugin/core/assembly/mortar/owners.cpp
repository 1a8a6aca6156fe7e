#include "assembly/mortar/owners.h"

#include "assembly/mortar/search.h"
#include "assembly/mortar/sheets.h"

namespace frictioncg::mortar {

Ways::Ways(const Sides& of, const std::vector<std::vector<Index>>& rank) : of_(of) {
  std::map<Index, Index> one;  // patch at a node, the first that was met
  for_each_covered(of, [&](std::size_t p, Index f, Index i) {
    if (one.emplace(i, rank[p][f]).first->second != rank[p][f]) nearest_[i] = infinity;
  });
  for_each_covered(of, [&](std::size_t p, Index f, Index i) {
    const auto least = nearest_.find(i);
    if (least != nearest_.end()) least->second = std::min(least->second, way(p, f, i));
  });
}

Real Ways::farther(std::size_t p, Index f, Index i) const {
  const auto least = nearest_.find(i);
  if (least == nearest_.end() || least->second == infinity) return 0;
  return (way(p, f, i) - least->second) / of_.slaves[p].planes[f].size;
}

/// To the plane of what faces it, so that a corner on a slope is as far along a face that the slope
/// hardly faces as along its foot; there the foot is a little nearer. With its sign: what overlaps
/// most is nearest. Infinite where nothing faces the vertex itself.
Real Ways::way(std::size_t p, Index f, Index i) const {
  const int v = position(of_.slaves[p].facet(f), i);
  const std::vector<Cell>& cells = of_.covers[p].cells[f];
  const auto reaches = [&](const Cell& cell) {
    return std::any_of(cell.part.begin(), cell.part.end(), [&](const Vec2& xi) {
      return (v == 0 ? 1 - xi.sum() : xi[v - 1]) > 1 - equally_near;  // lambda_v
    });
  };
  if (std::none_of(cells.begin(), cells.end(), reaches)) return infinity;
  const FacedAtVertex there =
      faced_at_vertex(v, of_.slaves[p], f, of_.masters[p], of_.nodes.X, cells);
  const Plane& plane = of_.slaves[p].planes[f];
  const Real cosine = plane.normal.dot(of_.masters[p].planes[there.master].normal);
  return -there.distance * cosine + (cosine > hardly ? 2 * equally_near * plane.size : 0);
}

namespace {

class Sparing {
 public:
  Sparing(const Sides& of, const Ways& ways, const Carries& carries, Ranked& ranked)
      : of_(of), ways_(ways), carries_(carries), ranked_(ranked) {}
  void run() {
    for (const Side& slave : of_.slaves) own_.emplace_back(slave.facets());
    for_each_covered(of_, [&](std::size_t p, Index f, Index i) {
      own_[p][f] += ranked_.owner[i] == ranked_.rank[p][f] && carries_(p, f, i);
    });
    Places without;
    for (std::size_t p = 0; p < of_.slaves.size(); ++p)
      for (Index f = 0; f < of_.slaves[p].facets(); ++f)
        if (!of_.covers[p].cells[f].empty() && own_[p][f] == 0) without.push_back({p, f});
    if (without.empty()) return;
    at_.resize(ranked_.owner.size());
    for_each_covered(of_, [&](std::size_t p, Index f, Index i) { at_[i].push_back({p, f}); });
    for (const Place& place : without)
      if (lacks(place) && provide(place, 0))
        seen_.clear();  // what leads nowhere does so until something moves
  }

 private:
  struct Place {
    std::size_t pair;
    Index facet;
  };
  using Places = std::vector<Place>;
  static constexpr int longest = 1000;  ///< chain of nodes that move: each is a call of the search

  Index rank(const Place& at) const { return ranked_.rank[at.pair][at.facet]; }
  /// The facets of its patch that share a vertex with one.
  Places around(const Place& at) const {
    Places all;
    for (int v = 0; v < of_.nodes.dimension; ++v)
      for (const Place& o : at_[of_.slaves[at.pair].facet(at.facet).node[v]])
        if (rank(o) == rank(at)) all.push_back(o);
    return all;
  }
  /// Whether no facet of its patch around it has a node.
  bool lacks(const Place& at) const {
    const Places all = around(at);
    return std::all_of(all.begin(), all.end(),
                       [&](const Place& o) { return own_[o.pair][o.facet] == 0; });
  }
  void give(Index i, Index to, std::size_t pair) {
    for (const Place& o : at_[i])
      if (carries_(o.pair, o.facet, i))
        own_[o.pair][o.facet] += (rank(o) == to) - (rank(o) == ranked_.owner[i]);
    ranked_.owner[i] = to, ranked_.pair[i] = static_cast<Index>(pair);
  }
  /// Whether a patch does without a node, at the facets there and around them, or gets others.
  bool spares(Index patch, Index i, int depth) {
    return std::all_of(at_[i].begin(), at_[i].end(), [&](const Place& o) {
      const Places all = rank(o) == patch ? around(o) : Places();
      return std::all_of(all.begin(), all.end(), [&](const Place& q) { return provide(q, depth); });
    });
  }
  /// Finds a node for a facet, as long as it lacks one; the nodes that were seen stay where they
  /// are.
  bool provide(const Place& to, int depth) {
    if (!lacks(to)) return true;
    if (depth > longest) return false;
    const auto& node = of_.slaves[to.pair].facet(to.facet).node;
    std::vector<Index> nodes(node.begin(), node.begin() + of_.nodes.dimension);
    std::stable_sort(nodes.begin(), nodes.end(), [&](Index i, Index j) {
      return ways_.farther(to.pair, to.facet, i) < ways_.farther(to.pair, to.facet, j);
    });
    for (Index i : nodes) {
      if (!carries_(to.pair, to.facet, i) || !seen_.insert(i).second) continue;
      const Index from = ranked_.owner[i], pair = ranked_.pair[i];
      give(i, rank(to), to.pair);
      if (spares(from, i, depth + 1)) return true;
      give(i, from, static_cast<std::size_t>(pair));
    }
    return false;
  }

  const Sides& of_;
  const Ways& ways_;
  const Carries& carries_;
  Ranked& ranked_;
  std::vector<std::vector<Index>> own_;  ///< how many vertices a facet's own patch has there
  std::vector<Places> at_;               ///< covered facets at each node
  std::set<Index> seen_;
};

}  // namespace

void spare(const Sides& of, const Ways& ways, const Carries& carries, Ranked& ranked) {
  Sparing(of, ways, carries, ranked).run();
}

}  // namespace frictioncg::mortar
