#include "condensed/ordering.h"

#include <new>

namespace frictioncg {

cholmod_sparse symmetric_view(Index n, std::vector<Index>& column, std::vector<Index>& row,
                              Real* value) {
  cholmod_sparse view{};
  view.nrow = view.ncol = n;
  view.nzmax = row.size();
  view.p = column.data();
  view.i = row.data();
  view.x = value;
  view.stype = 1;
  view.itype = CHOLMOD_INT;
  view.xtype = value ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = value != nullptr;  // the rows of a pattern come as the graph was walked
  view.packed = 1;
  return view;
}

namespace {

/// The graph of the mesh nodes: its upper triangle by columns, and the dofs of each node.
struct NodeGraph {
  std::vector<Index> column, row;
  std::vector<Index> first_dof;  ///< nodes + 1, into dofs
  std::vector<Index> dofs;
  Index interior = 0;  ///< nodes with interior dofs; contact nodes follow
  cholmod_sparse view{};

  explicit NodeGraph(const System& s) {
    const Index n = s.dofs();
    std::vector<Index> node_of(n);
    number_nodes(s, node_of);
    const Index nodes = static_cast<Index>(first_dof.size()) - 1;
    const auto [begin, col, a] = arrays_of(s.entries());
    std::vector<Index> seen_by(nodes, -1);
    column.reserve(nodes + 1);
    column.push_back(0);
    for (Index v = 0; v < nodes; ++v) {
      for (Index k = first_dof[v]; k < first_dof[v + 1]; ++k)
        for (Index e = begin[dofs[k]]; e < begin[dofs[k] + 1]; ++e) {
          const Index w = node_of[col[e]];
          if (w >= v || seen_by[w] == v) continue;
          seen_by[w] = v;
          row.push_back(w);
        }
      column.push_back(static_cast<Index>(row.size()));
    }
    view = symmetric_view(nodes, column, row, nullptr);
  }

  /// The dofs of the first so many nodes of an order.
  std::vector<Index> dofs_of(const std::vector<Index>& order, Index count) const {
    std::vector<Index> list;
    list.reserve(dofs.size());
    for (Index v = 0; v < count; ++v)
      for (Index k = first_dof[order[v]]; k < first_dof[order[v] + 1]; ++k) list.push_back(dofs[k]);
    return list;
  }

 private:
  void number_nodes(const System& s, std::vector<Index>& node_of) {
    const Index n = s.dofs();
    Index nodes = 0;
    if (s.mesh_node.empty()) {
      for (Index i = 0; i < s.interior(); ++i) node_of[i] = nodes++;
    } else {
      std::vector<Index> number(*std::max_element(s.mesh_node.begin(), s.mesh_node.end()) + 1, -1);
      for (Index i = 0; i < s.interior(); ++i) {
        Index& k = number[s.mesh_node[i]];
        if (k < 0) k = nodes++;
        node_of[i] = k;
      }
    }
    interior = nodes;
    for (Index c = 0; c < s.nodes(); ++c, ++nodes)
      for (Index i = s.first[c]; i < s.first[c + 1]; ++i) node_of[i] = nodes;
    first_dof.assign(nodes + 1, 0);
    for (Index i = 0; i < n; ++i) ++first_dof[node_of[i] + 1];
    std::partial_sum(first_dof.begin(), first_dof.end(), first_dof.begin());
    dofs.resize(n);
    std::vector<Index> at(first_dof.begin(), first_dof.end() - 1);
    for (Index i = 0; i < n; ++i) dofs[at[node_of[i]]++] = i;
  }
};

}  // namespace

void check(bool ok, const cholmod_common& common) {
  if (ok) return;
  if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  throw std::runtime_error("CHOLMOD failed with status " + std::to_string(common.status));
}

std::vector<Index> contact_last(const System& s, cholmod_common& common) {
  NodeGraph graph(s);
  const Index nodes = static_cast<Index>(graph.first_dof.size()) - 1;
  std::vector<Index> order(nodes);
  int ok = 1;
  if (graph.interior == 0) {
    // all dofs are contact dofs
  } else if (s.dimension == 2) {
    std::vector<Index> member(nodes, 0);
    std::fill(member.begin() + graph.interior, member.end(), 1);
    ok = cholmod_camd(&graph.view, nullptr, 0, member.data(), order.data(), &common);
  } else {
    graph.view.nrow = graph.view.ncol = graph.interior;
    graph.view.nzmax = graph.column[graph.interior];
    ok = cholmod_metis(&graph.view, nullptr, 0, 0, order.data(), &common);
  }
  if (!ok && common.status == CHOLMOD_TOO_LARGE) return {};
  check(ok, common);
  std::vector<Index> dofs = graph.dofs_of(order, graph.interior);
  for (Index i = s.interior(); i < s.dofs(); ++i) dofs.push_back(i);
  return dofs;
}

std::vector<Index> by_nodes(const System& s, cholmod_common& common) {
  NodeGraph graph(s);
  std::vector<Index> order(graph.view.nrow);
  const bool ok = cholmod_amd(&graph.view, nullptr, 0, order.data(), &common);
  if (!ok && common.status == CHOLMOD_TOO_LARGE) return {};
  check(ok, common);
  return graph.dofs_of(order, static_cast<Index>(order.size()));
}

std::vector<Index> last_of_each_part(const System& s, const std::vector<Index>& order) {
  const auto [row, col, a] = arrays_of(s.entries());
  Groups parts(s.interior());
  for (Index i = 0; i < s.interior(); ++i)
    for (Index e = row[i]; col[e] < i; ++e) parts.join(i, col[e]);
  std::vector<char> seen(s.interior(), 0);
  std::vector<Index> roots;
  for (Index k = s.interior() - 1; k >= 0; --k)
    if (!std::exchange(seen[parts.of(order[k])], 1)) roots.push_back(order[k]);
  return roots;
}

}  // namespace frictioncg
