#include "assembly/mortar/owners.h"

#include "assembly/mortar/sheets.h"

namespace frictioncg::mortar {

Ways::Ways(const std::vector<Side>& slaves, const std::vector<Side>& masters,
           const std::vector<Cover>& covers, const std::vector<Vec3>& X,
           const std::vector<std::vector<Index>>& rank)
    : slaves_(slaves), masters_(masters), covers_(covers), X_(X) {
  std::map<Index, Index> one;  // patch at a node, the first that was met
  for_each_covered(slaves, covers, [&](std::size_t p, Index f, Index i) {
    if (one.emplace(i, rank[p][f]).first->second != rank[p][f]) nearest_[i] = infinity;
  });
  for_each_covered(slaves, covers, [&](std::size_t p, Index f, Index i) {
    const auto least = nearest_.find(i);
    if (least != nearest_.end()) least->second = std::min(least->second, way(p, f, i));
  });
}

Real Ways::farther(std::size_t p, Index f, Index i) const {
  const auto least = nearest_.find(i);
  if (least == nearest_.end() || least->second == infinity) return 0;
  return (way(p, f, i) - least->second) / slaves_[p].planes[f].size;
}

/// With its sign: what overlaps most is nearest. Infinite where nothing faces the vertex itself.
Real Ways::way(std::size_t p, Index f, Index i) const {
  const auto& node = slaves_[p].facet(f).node;
  const int v = static_cast<int>(std::find(node.begin(), node.end(), i) - node.begin());
  const std::vector<Cell>& cells = covers_[p].cells[f];
  const auto reaches = [&](const Cell& cell) {
    return std::any_of(cell.part.begin(), cell.part.end(), [&](const Vec2& xi) {
      return (v == 0 ? 1 - xi.sum() : xi[v - 1]) > 1 - equally_near;  // lambda_v
    });
  };
  if (std::none_of(cells.begin(), cells.end(), reaches)) return infinity;
  return faced_at_vertex(v, slaves_[p], f, masters_[p], X_, cells).distance;
}

namespace {

class Sparing {
 public:
  Sparing(const std::vector<Side>& slaves, const std::vector<Cover>& covers,
          const std::vector<std::vector<Index>>& rank, const Ways& ways, Owners owners)
      : slaves_(slaves), rank_(rank), ways_(ways), owners_(owners) {
    for (const Side& slave : slaves) own_.emplace_back(slave.facets());
    for_each_covered(slaves, covers, [&](std::size_t p, Index f, Index i) {
      own_[p][f] += owners_.rank[i] == rank[p][f] && !taken(i);
    });
    Places lacking;
    for (const bool all : {false, true}) {  // few facets have none, and hardly ever one lacks some
      at_.clear();
      for_each_covered(slaves, covers, [&](std::size_t p, Index f, Index i) {
        if (own_[p][f] == 0) at_[i];
      });
      for_each_covered(slaves, covers, [&](std::size_t p, Index f, Index i) {
        if (all || at_.count(i) > 0) at_[i][rank[p][f]].push_back({p, f});
      });
      lacking.clear();
      for (std::size_t p = 0; p < slaves.size(); ++p)
        for (Index f = 0; f < slaves[p].facets(); ++f)
          if (!covers[p].cells[f].empty() && lacks({p, f})) lacking.push_back({p, f});
      if (lacking.empty()) return;
    }
    for (const Place& place : lacking)
      if (provide(place)) seen_.clear();  // what leads nowhere does so until something moves
  }

 private:
  struct Place {
    std::size_t pair;
    Index facet;
  };
  using Places = std::vector<Place>;

  bool taken(Index i) const { return !owners_.taken.empty() && owners_.taken[i]; }
  /// Whether no facet of its patch around it has a node.
  bool lacks(const Place& at) {
    if (own_[at.pair][at.facet] > 0) return false;
    const Side& slave = slaves_[at.pair];
    for (int v = 0; v < slave.d; ++v)
      for (const Place& o : at_[slave.facet(at.facet).node[v]][rank_[at.pair][at.facet]])
        if (own_[o.pair][o.facet] > 0) return false;
    return true;
  }
  void give(Index i, Index rank, std::size_t pair) {
    for (const Place& o : at_[i][owners_.rank[i]]) --own_[o.pair][o.facet];
    for (const Place& o : at_[i][rank]) ++own_[o.pair][o.facet];
    owners_.rank[i] = rank, owners_.pair[i] = static_cast<Index>(pair);
  }
  /// Finds a node for a facet, as long as it lacks one; the nodes that were seen stay where they
  /// are.
  bool provide(const Place& to) {
    if (!lacks(to)) return true;
    const auto& node = slaves_[to.pair].facet(to.facet).node;
    std::vector<Index> nodes(node.begin(), node.begin() + slaves_[to.pair].d);
    std::stable_sort(nodes.begin(), nodes.end(), [&](Index i, Index j) {
      return ways_.farther(to.pair, to.facet, i) < ways_.farther(to.pair, to.facet, j);
    });
    for (Index i : nodes) {
      if (taken(i) || !seen_.insert(i).second) continue;
      const Index rank = owners_.rank[i], pair = owners_.pair[i];
      give(i, rank_[to.pair][to.facet], to.pair);
      const Places& left = at_[i][rank];
      if (std::all_of(left.begin(), left.end(), [&](const Place& o) { return provide(o); }))
        return true;
      give(i, rank, static_cast<std::size_t>(pair));
    }
    return false;
  }

  const std::vector<Side>& slaves_;
  const std::vector<std::vector<Index>>& rank_;
  const Ways& ways_;
  Owners owners_;
  std::vector<std::vector<Index>> own_;          ///< vertices of each facet's own patch
  std::map<Index, std::map<Index, Places>> at_;  ///< facets at a node, by their patch
  std::set<Index> seen_;
};

}  // namespace

void spare(const std::vector<Side>& slaves, const std::vector<Cover>& covers,
           const std::vector<std::vector<Index>>& rank, const Ways& ways, Owners owners) {
  Sparing(slaves, covers, rank, ways, owners);
}

}  // namespace frictioncg::mortar
