#include "multigrid/aggregation.h"

namespace frictioncg {

namespace {

/// Keeps the strength of a row that no dof fills from being 0/0: near the least normal number of
/// single precision.
constexpr float least_float = 1e-37f;
/// Couplings of less than this share of their diagonals are rounding in single precision.
constexpr float no_coupling = 1e-6f;
/// A threshold on the couplings that was halved to less than this excludes nothing of weight: all
/// couplings count from there on.
constexpr float no_threshold = 0.01f;

}  // namespace

template <int B>
BlockGraph make_graph(const SymmetricBlocks<B>& A) {
  const Index rows = A.rows();
  to_block_index(2 * A.col.size());
  BlockGraph g;
  g.begin.assign(rows + 1, 0);
  for (Index i = 0; i < rows; ++i)
    for (Index k = A.row[i]; k < A.row[i + 1]; ++k) ++g.begin[i + 1], ++g.begin[A.col[k] + 1];
  for (Index i = 0; i < rows; ++i) g.begin[i + 1] += g.begin[i];
  g.neighbour.resize(g.begin[rows]);
  g.stored.resize(g.begin[rows]);
  std::vector<Index> next(g.begin.begin(), g.begin.end() - 1);
  const auto insert = [&](Index i, Index j, Index k) {
    g.neighbour[next[i]] = j;
    g.stored[next[i]++] = k;
  };
  // row i gets its lower neighbours now, and its upper ones from the rows after it: both in order
  for (Index i = 0; i < rows; ++i)
    for (Index k = A.row[i]; k < A.row[i + 1]; ++k) insert(i, A.col[k], k), insert(A.col[k], i, k);
  return g;
}

template <int B>
std::vector<float> coupling_strength(const SymmetricBlocks<B>& A) {
  const auto norm2 = [](const float* a) {
    float sum = 0;
    for (int e = 0; e < B * B; ++e) sum += a[e] * a[e];
    return sum;
  };
  std::vector<float> diagonal(A.rows()), strength(A.col.size());
  for (Index i = 0; i < A.rows(); ++i) diagonal[i] = std::sqrt(norm2(A.diagonal_at(i)));
  for (Index i = 0; i < A.rows(); ++i)
    for (Index k = A.row[i]; k < A.row[i + 1]; ++k)
      strength[k] = std::sqrt(norm2(A.at(k)) / (diagonal[i] * diagonal[A.col[k]] + least_float));
  return strength;
}

namespace {

/// The neighbours that count.
class StrongGraph {
 public:
  StrongGraph(const BlockGraph& graph, const std::vector<float>& strength, float threshold)
      : graph_(graph), strength_(strength), least_(graph.rows(), 0) {
    if (threshold <= 0) return;
    for (Index i = 0; i < graph.rows(); ++i) {
      for (Index e = graph.begin[i]; e < graph.begin[i + 1]; ++e)
        least_[i] = std::max(least_[i], strength[graph.stored[e]]);
      least_[i] *= threshold;
    }
  }
  /// visit(neighbour, strength)
  template <class Visit>
  void for_each(Index i, Visit visit) const {
    for (Index e = graph_.begin[i]; e < graph_.begin[i + 1]; ++e) {
      const Index j = graph_.neighbour[e];
      const float s = strength_[graph_.stored[e]];
      if (s > no_coupling && (s >= least_[i] || s >= least_[j])) visit(j, s);
    }
  }

 private:
  const BlockGraph& graph_;
  const std::vector<float>& strength_;
  std::vector<float> least_;
};

Aggregates aggregate_at(const BlockGraph& graph, const std::vector<float>& strength,
                        float threshold) {
  constexpr Index left = -1;
  const StrongGraph strong(graph, strength, threshold);
  Aggregates a;
  a.of.assign(graph.rows(), left);
  for (Index i = 0; i < graph.rows(); ++i) {
    if (a.of[i] != left) continue;
    bool alone = true;
    strong.for_each(i, [&](Index j, float) { alone = alone && a.of[j] == left; });
    if (!alone) continue;
    a.of[i] = a.count;
    strong.for_each(i, [&](Index j, float) { a.of[j] = a.count; });
    ++a.count;
  }
  const std::vector<Index> first = a.of;
  for (Index i = 0; i < graph.rows(); ++i) {
    if (first[i] != left) continue;
    float strongest = 0;
    strong.for_each(i, [&](Index j, float s) {
      if (first[j] != left && s > strongest) strongest = s, a.of[i] = first[j];
    });
  }
  for (Index i = 0; i < graph.rows(); ++i) {
    if (a.of[i] != left) continue;
    a.of[i] = a.count;
    strong.for_each(i, [&](Index j, float) {
      if (a.of[j] == left) a.of[j] = a.count;
    });
    ++a.count;
  }
  return a;
}

}  // namespace

Aggregates aggregate(const BlockGraph& graph, const std::vector<float>& strength,
                     Coarsening coarsening) {
  for (float threshold = coarsening.threshold;; threshold /= 2) {
    if (threshold < no_threshold) return aggregate_at(graph, strength, 0);
    Aggregates a = aggregate_at(graph, strength, threshold);
    if (float(a.count) * coarsening.ratio <= float(graph.rows())) return a;
  }
}

#define FRICTIONCG_INSTANTIATE(B)                            \
  template BlockGraph make_graph(const SymmetricBlocks<B>&); \
  template std::vector<float> coupling_strength(const SymmetricBlocks<B>&);
FRICTIONCG_BLOCKS(FRICTIONCG_INSTANTIATE)
#undef FRICTIONCG_INSTANTIATE

}  // namespace frictioncg
