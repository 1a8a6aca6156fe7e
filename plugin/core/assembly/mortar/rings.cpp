#include <tuple>

#include "assembly/mortar/ownership.h"

namespace frictioncg::mortar {

namespace {

/// Laws that depend on others: by their nodes, which on which.
using Links = std::vector<std::pair<Index, Index>>;

/// Takes off what depends on nothing, or on what nothing depends, again and again: what is left is
/// rings, sorted, and what is between two of them.
void leave_rings(Links& links) {
  sort_once(links);
  for (std::size_t before = 0; before != links.size();) {
    before = links.size();
    std::vector<Index> of, on;
    for (const auto& [i, r] : links) {
      of.push_back(i);
      on.push_back(r);
    }
    std::sort(on.begin(), on.end());
    const auto is_end = [&](const auto& link) {
      return !std::binary_search(on.begin(), on.end(), link.first) ||
             !std::binary_search(of.begin(), of.end(), link.second);
    };
    links.erase(std::remove_if(links.begin(), links.end(), is_end), links.end());
  }
}

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
      Links laws;
      for_each_removed(*this, of.slaves, [&](Carriers&, Index i, int, int, Index r) {
        if (!takes(i, r)) laws.emplace_back(i, r);
      });
      if (laws.empty()) return;
      if (with_masters)
        for_each_faced(*this, of, [&](Index i, Index l) { laws.emplace_back(i, l); });
      leave_rings(laws);
      changed = false;
      for_each_removed(*this, of.slaves, [&](Carriers& there, Index i, int v, int r, Index of_r) {
        const bool in_ring = std::binary_search(laws.begin(), laws.end(), std::pair(i, of_r));
        if (!in_ring || !leads_back(i, of_r)) return;
        take(there, i, v, r, of_r);
        changed = true;
      });
    }
  }
}

}  // namespace frictioncg::mortar
