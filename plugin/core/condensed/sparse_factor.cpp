#include "condensed/sparse_factor.h"

#include <new>

#if __has_include(<sys/mman.h>)
#include <sys/mman.h>
#endif

#include "threads.h"

namespace frictioncg {

namespace {

/// Throws what CHOLMOD's status says where a call of it has failed.
void check(bool ok, const cholmod_common& common) {
  if (ok) return;
  if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  throw std::runtime_error("CHOLMOD failed with status " + std::to_string(common.status));
}

/// CHOLMOD's view of the upper triangle of a symmetric matrix, or of its pattern (value null).
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

/// A factor is touched all at once: a fault for each small page would take a fifth of the
/// factorization where the system gives large ones to who asks alone.
void in_large_pages(void* begin, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::size_t page = 4096;
  const std::size_t skip = -reinterpret_cast<std::size_t>(begin) % page;
  if (bytes > page) madvise(static_cast<char*>(begin) + skip, bytes - skip, MADV_HUGEPAGE);
#endif
}

}  // namespace

std::vector<Index> contact_last(const System& s, cholmod_common& common) {
  NodeGraph graph(s);
  std::vector<Index> order(graph.view.nrow);
  int ok = 1;
  if (graph.interior == 0) {
    // all dofs are contact dofs
  } else if (s.dimension == 2) {
    std::vector<Index> member(order.size(), 0);
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

UpperTriangle::UpperTriangle(const System& s, const std::vector<char>& chained,
                             const std::vector<Index>& roots) {
  const Index n = s.dofs();
  const auto [begin, col, a] = arrays_of(s.entries());
  column.reserve(n + 1);
  row.reserve(s.entries().nonZeros() / 2 + n);
  value.reserve(s.entries().nonZeros() / 2 + n);
  column.push_back(0);
  for (Index j = 0; j < n; ++j) {
    for (Index k = begin[j]; k < begin[j + 1] && col[k] < j; ++k) {
      row.push_back(col[k]);
      value.push_back(a[k]);
    }
    if (j == s.interior())
      for (const Index r : roots) {  // the column stays sorted
        const auto at = std::lower_bound(row.begin() + column.back(), row.end(), r);
        if (at != row.end() && *at == r) continue;
        value.insert(value.begin() + (at - row.begin()), 0);
        row.insert(at, r);
      }
    if (chained[j] && (row.size() == std::size_t(column[j]) || row.back() != j - 1)) {
      row.push_back(j - 1);
      value.push_back(0);
    }
    row.push_back(j);
    value.push_back(s.D[j]);
    column.push_back(static_cast<Index>(row.size()));
  }
  view = symmetric_view(n, column, row, value.data());
}

SparseFactor::SparseFactor(int supernodal) {
  cholmod_start(&common_);
  common_.print = 0;
  common_.try_catch = 1;
  common_.supernodal = supernodal;
  common_.final_ll = 1;
  common_.nmethods = 1;
  common_.method[0].ordering = CHOLMOD_GIVEN;
}

SparseFactor::~SparseFactor() {
  release();
  cholmod_finish(&common_);
}

void SparseFactor::release() {
  cholmod_free_factor(&L_, &common_);
  for (cholmod_dense** workspace : {&X_, &Y_, &E_}) cholmod_free_dense(workspace, &common_);
}

bool SparseFactor::lay_out(cholmod_sparse& view, const std::vector<Index>& order) {
  cholmod_free_factor(&L_, &common_);
  if (order.size() < view.ncol) return false;  // the ordering has been too large
  L_ = cholmod_analyze_p(&view, const_cast<Index*>(order.data()), nullptr, 0, &common_);
  if (common_.status == CHOLMOD_TOO_LARGE) return false;
  check(L_ != nullptr, common_);
  return true;
}

bool SparseFactor::factorize(cholmod_sparse& view) {
  if (L_->is_super && L_->xtype == CHOLMOD_PATTERN) {
    check(cholmod_change_factor(CHOLMOD_REAL, 1, 1, 1, 1, L_, &common_), common_);
    in_large_pages(L_->x, sizeof(Real) * L_->xsize);
  }
  const Threads threads(threads_pay());
  const bool done = cholmod_factorize(&view, L_, &common_);
  if (common_.status == CHOLMOD_NOT_POSDEF) return false;
  check(done, common_);
  return true;
}

/// By flops over entries. On two cores threads take 0.8 of the time from 900 on, as in 3D, and 0.9
/// to 1.2 of it below 600, as in 2D, for twice the CPU time.
bool SparseFactor::threads_pay() const { return common_.fl > 800 * common_.lnz; }

Vector SparseFactor::solve(int triangle, const Vector& rhs) {
  const std::size_t n = rhs.size();
  cholmod_dense b{n, 1, n, n, const_cast<Real*>(rhs.data()), nullptr, CHOLMOD_REAL, CHOLMOD_DOUBLE};
  // cholmod_solve2 would make its own, but goes on without where there is no memory
  const auto ensure = [this](cholmod_dense*& workspace, std::size_t rows) {
    check(cholmod_ensure_dense(&workspace, rows, 1, rows, CHOLMOD_REAL, &common_), common_);
  };
  ensure(X_, n);
  ensure(Y_, n);
  ensure(E_, L_->maxesize);
  check(cholmod_solve2(triangle, L_, &b, nullptr, &X_, nullptr, &Y_, &E_, &common_), common_);
  return Eigen::Map<const Vector>(static_cast<Real*>(X_->x), rhs.size());
}

}  // namespace frictioncg
