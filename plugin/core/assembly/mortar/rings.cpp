#include <tuple>

#include "assembly/mortar/ownership.h"

namespace frictioncg::mortar {

namespace {

/// Laws that depend on others, by their nodes.
class Dependence {
 public:
  void add(Index of, Index on) {
    if (on_[of].insert(on).second) of_[on].insert(of);
  }
  /// Takes off what depends on nothing, or on what nothing depends, again and again: what is left
  /// is rings, and what is between two of them.
  void leave_rings() {
    std::vector<Index> ends;
    for (const auto& [i, on] : on_) ends.push_back(i);
    for (const auto& [i, of] : of_) ends.push_back(i);
    for (; !ends.empty();) {
      const Index i = ends.back();
      ends.pop_back();
      take_off(i, on_, of_, ends);
      take_off(i, of_, on_, ends);
    }
  }
  bool empty() const { return on_.empty(); }
  bool has(Index of, Index on) const {
    const auto found = on_.find(of);
    return found != on_.end() && found->second.count(on) > 0;
  }

 private:
  using Links = std::map<Index, std::set<Index>>;
  /// Of a node with links one way alone.
  static void take_off(Index i, Links& ways, Links& back, std::vector<Index>& ends) {
    const auto found = ways.find(i);
    if (found == ways.end() || back.count(i) > 0) return;
    for (Index k : found->second) {
      const auto there = back.find(k);
      there->second.erase(i);
      if (there->second.empty()) back.erase(there);
      ends.push_back(k);
    }
    ways.erase(found);
  }
  Links on_, of_;
};

/// visit(facet's carriers, i, v, r, r's node): laws of nodes i on a facet, at its vertex v or
/// elsewhere (-1), where a node that has its law on another facet is removed, at its vertex r.
template <class Visit>
void for_each_removed(Ownership& ownership, const std::vector<Side>& slaves, const Visit& visit) {
  for (std::size_t p = 0; p < slaves.size(); ++p)
    for (Index f = 0; f < slaves[p].facets(); ++f) {
      Ownership::Carriers& of = ownership.carriers[p][f];
      const auto& node = slaves[p].facet(f).node;
      for (int r = 0; r < slaves[p].d; ++r) {
        if (ownership.state[node[r]] != Ownership::State::kept) continue;
        for (int v = 0; v < slaves[p].d; ++v)
          if (of.kept[v] && v != r && of.depends(v, r)) visit(of, node[v], v, r, node[r]);
        for (Index i : of.stand_in)
          if (i != node[r]) visit(of, i, -1, r, node[r]);
      }
    }
}

/// visit(i, l): laws of nodes i, and nodes l with a law on the masters before them.
template <class Visit>
void for_each_faced(const Ownership& ownership, const Sides& of, const Visit& visit) {
  const int d = of.nodes.dimension;
  for (std::size_t p = 0; p < of.slaves.size() && of.slaves.size() > 1; ++p)
    for (Index f = 0; f < of.slaves[p].facets(); ++f)
      for (const Cell& cell : of.covers[p].cells[f]) {
        const Facet& facet = of.masters[p].facet(cell.master);
        std::vector<Index> seen(facet.node.begin(), facet.node.begin() + d);
        if (facet.behind >= 0) seen.push_back(facet.behind);
        const Ownership::Carriers& carriers = ownership.carriers[p][f];
        for (Index l : seen) {
          if (ownership.state[l] != Ownership::State::kept) continue;
          for (int v = 0; v < d; ++v)
            if (carriers.kept[v]) visit(of.slaves[p].facet(f).node[v], l);
          for (Index i : carriers.stand_in) visit(i, l);
        }
      }
}

}  // namespace

/// Laws depend on those of removed nodes, of any patch, and on those of nodes of their masters, of
/// pairs before their own. In a ring that leads from a patch to one with fewer nodes the law takes
/// on itself what its removed nodes move by: one node that stands for a face is to spread its force
/// over all of that. Where masters are in the ring so does each law whose removed node is a later
/// pair's.
void Ownership::break_rings(const Sides& of) {
  const auto take = [&](Carriers& there, Index i, int v, int r, Index of_r) {
    taken.insert({i, of_r});
    if (v >= 0) there.takes(v, r) = 1;
  };
  for_each_removed(*this, of.slaves, [&](Carriers& there, Index i, int v, int r, Index of_r) {
    if (takes(i, of_r)) take(there, i, v, r, of_r);
  });
  if (nodes_of_patch.empty()) {
    nodes_of_patch.assign(static_cast<std::size_t>(patches), 0);
    for (std::size_t i = 0; i < owner.size(); ++i)
      if (state[i] == State::kept) ++nodes_of_patch[owner[i]];
  }
  for (const bool with_masters : {false, true}) {
    const auto leads_back = [&](Index i, Index r) {
      const Index first = with_masters ? pair[i] : 0, next = with_masters ? pair[r] : 0;
      return std::tuple(-next, nodes_of_patch[owner[r]], owner[r]) <
             std::tuple(-first, nodes_of_patch[owner[i]], owner[i]);
    };
    for (bool changed = true; changed;) {
      Dependence laws;
      for_each_removed(*this, of.slaves, [&](Carriers&, Index i, int, int, Index r) {
        if (!takes(i, r)) laws.add(i, r);
      });
      if (laws.empty()) return;
      if (with_masters) for_each_faced(*this, of, [&](Index i, Index l) { laws.add(i, l); });
      laws.leave_rings();
      changed = false;
      for_each_removed(*this, of.slaves, [&](Carriers& there, Index i, int v, int r, Index of_r) {
        if (!laws.has(i, of_r) || !leads_back(i, of_r)) return;
        take(there, i, v, r, of_r);
        changed = true;
      });
    }
  }
}

}  // namespace frictioncg::mortar
