#include "multigrid/prolongation.h"

#include "multigrid/smoother.h"

namespace frictioncg {

namespace {

/// A mode of which less than this share is left beside the others depends on them.
constexpr Real dependent_mode = 1e-7;
/// A pivot of which less than this share is left is rounding.
constexpr float lost = 1e-5f;
constexpr int power_steps = 8;  ///< of spectral_radius

/// Modified Gram-Schmidt, twice, on the columns of Q; R of Q R. Dependent columns become 0.
template <int K>
Eigen::Matrix<Real, K, K> orthonormalize(Eigen::Matrix<Real, Eigen::Dynamic, K>& Q) {
  Eigen::Matrix<Real, K, K> R = Eigen::Matrix<Real, K, K>::Zero();
  for (int k = 0; k < K; ++k) {
    const Real before = Q.col(k).norm();
    for (int pass = 0; pass < 2; ++pass)
      for (int l = 0; l < k; ++l) {
        const Real along = Q.col(l).dot(Q.col(k));
        R(l, k) += along;
        Q.col(k) -= along * Q.col(l);
      }
    const Real after = Q.col(k).norm();
    if (!(after > dependent_mode * before)) {
      Q.col(k).setZero();
      continue;
    }
    R(k, k) = after;
    Q.col(k) /= after;
  }
  return R;
}

}  // namespace

template <int B, int K>
Tentative<B, K> make_tentative(const Aggregates& aggregates, const Modes<K>& modes) {
  std::vector<std::vector<Index>> members(aggregates.count);
  for (std::size_t i = 0; i < aggregates.of.size(); ++i)
    members[aggregates.of[i]].push_back(static_cast<Index>(i));
  Tentative<B, K> t;
  t.value.assign(aggregates.of.size() * B * K, 0);
  t.coarse.setZero(Eigen::Index(aggregates.count) * K, K);
  for (Index c = 0; c < aggregates.count; ++c) {
    const std::vector<Index>& rows = members[c];
    Eigen::Matrix<Real, Eigen::Dynamic, K> Q(Eigen::Index(rows.size()) * B, K);
    for (std::size_t q = 0; q < rows.size(); ++q)
      Q.template middleRows<B>(Eigen::Index(q) * B) =
          modes.template middleRows<B>(Eigen::Index(rows[q]) * B);
    t.coarse.template middleRows<K>(Eigen::Index(c) * K) = orthonormalize<K>(Q);
    for (std::size_t q = 0; q < rows.size(); ++q)
      Eigen::Map<Eigen::Matrix<float, B, K, Eigen::RowMajor>>(t.value.data() +
                                                              std::size_t(rows[q]) * B * K) =
          Q.template middleRows<B>(Eigen::Index(q) * B).template cast<float>();
  }
  return t;
}

/// y = -A x, and x := D^{-1} y; returns -<y, x_new> / <y, x_old>, a Rayleigh quotient.
template <int B>
float spectral_radius(const SymmetricBlocks<B>& A) {
  const std::vector<float> zero(std::size_t(A.rows()) * stride<B>, 0);
  std::vector<float> x = zero, y = zero;
  unsigned random = 12345;
  for (std::size_t i = 0; i < x.size(); i += stride<B>)
    for (int k = 0; k < B; ++k) {
      random = random * 1664525u + 1013904223u;
      x[i + k] = static_cast<float>(random >> 8) / (1 << 24) - 0.5f;
    }
  Real lambda = 1;
  for (int step = 0; step < power_steps; ++step) {
    subtract_product(A, zero.data(), x.data(), y.data());
    Real y_x = 0, y_z = 0;
    for (Index i = 0; i < A.rows(); ++i) {
      const std::size_t at = i * stride<B>;
      std::fill(&y[at] + B, &y[at] + stride<B>, 0.0f);
      BlockSum<B, B> z;
      z.add(A.inverse_at(i), &y[at]);
      for (int k = 0; k < B; ++k) {
        y_x -= Real(y[at + k]) * x[at + k];
        y_z += Real(y[at + k]) * z[k];
        x[at + k] = z[k];
      }
    }
    if (!(y_x > 0)) break;
    lambda = y_z / y_x;
    const float norm = static_cast<float>(std::sqrt(y_z));
    for (float& value : x) value /= norm;
  }
  return static_cast<float>(lambda);
}

/// The aggregates of row i and of its neighbours, ascending, each once.
void aggregates_beside(Index i, const BlockGraph& graph, const Aggregates& aggregates,
                       std::vector<Index>& columns) {
  columns.assign(1, aggregates.of[i]);
  for (Index e = graph.begin[i]; e < graph.begin[i + 1]; ++e)
    columns.push_back(aggregates.of[graph.neighbour[e]]);
  sort_once(columns);
}

template <int B, int K>
Prolongation<B, K> smooth(const SymmetricBlocks<B>& A, const BlockGraph& graph,
                          const Aggregates& aggregates, const std::vector<float>& tentative,
                          float omega) {
  Prolongation<B, K> P;
  P.columns = aggregates.count;
  P.row.reserve(A.rows() + 1);
  std::vector<Index> place(aggregates.count, -1);  // of an aggregate in the present row
  std::vector<Index> columns;
  std::vector<float> sum;
  const auto tentative_at = [&](Index j) { return tentative.data() + std::size_t(j) * B * K; };
  for (Index i = 0; i < A.rows(); ++i) {
    aggregates_beside(i, graph, aggregates, columns);
    for (std::size_t c = 0; c < columns.size(); ++c) place[columns[c]] = Index(c);

    sum.assign(columns.size() * B * K, 0);
    const auto sum_at = [&](Index j) {
      return sum.data() + std::size_t(place[aggregates.of[j]]) * B * K;
    };
    add_block_product<B, B, K>(1, A.diagonal_at(i), tentative_at(i), sum_at(i));
    for (Index e = graph.begin[i]; e < graph.begin[i + 1]; ++e) {
      const Index j = graph.neighbour[e];
      const float* a = A.at(graph.stored[e]);
      if (j < i)
        add_block_product<B, B, K>(1, a, tentative_at(j), sum_at(j));
      else
        add_transposed_block_product<B, B, K>(a, tentative_at(j), sum_at(j));
    }
    const std::size_t begin = P.col.size();
    P.col.insert(P.col.end(), columns.begin(), columns.end());
    P.row.push_back(to_block_index(P.col.size()));
    P.value.resize(P.col.size() * B * K, 0);
    for (std::size_t c = 0; c < columns.size(); ++c)
      add_block_product<B, B, K>(-omega, A.inverse_at(i), sum.data() + c * B * K, P.at(begin + c));
    float* own = P.at(begin + place[aggregates.of[i]]);
    for (int e = 0; e < B * K; ++e) own[e] += tentative_at(i)[e];
  }
  return P;
}

/// By Gauss-Jordan without pivoting on a symmetric positive semi-definite block.
template <int B>
void invert_diagonal(SymmetricBlocks<B>& A, Index row) {
  std::array<std::array<double, B>, B> M{};
  std::array<double, B> original{};
  const float* a = A.diagonal_at(row);
  for (int r = 0; r < B; ++r)
    for (int c = 0; c < B; ++c) M[r][c] = a[r * B + c];
  for (int k = 0; k < B; ++k) original[k] = M[k][k];
  for (int k = 0; k < B; ++k) {
    if (!(M[k][k] > lost * original[k])) {
      for (int j = 0; j < B; ++j) M[k][j] = M[j][k] = 0;
      continue;
    }
    // sweep k: M becomes minus the inverse on the swept slots
    const double pivot = 1 / M[k][k];
    for (int r = 0; r < B; ++r)
      for (int c = 0; c < B; ++c)
        if (r != k && c != k) M[r][c] -= M[r][k] * M[k][c] * pivot;
    for (int j = 0; j < B; ++j)
      if (j != k) M[k][j] = M[j][k] = M[j][k] * pivot;
    M[k][k] = -pivot;
  }
  float* inverse = A.inverse.data() + std::size_t(row) * B * B;
  for (int r = 0; r < B; ++r)
    for (int c = 0; c < B; ++c) inverse[r * B + c] = static_cast<float>(-M[r][c]);
}

#define FRICTIONCG_INSTANTIATE(B, K)                                                     \
  template Tentative<B, K> make_tentative<B, K>(const Aggregates&, const Modes<K>&);     \
  template Prolongation<B, K> smooth<B, K>(const SymmetricBlocks<B>&, const BlockGraph&, \
                                           const Aggregates&, const std::vector<float>&, float);
FRICTIONCG_PROLONGATIONS(FRICTIONCG_INSTANTIATE)
#undef FRICTIONCG_INSTANTIATE
#define FRICTIONCG_INSTANTIATE(B)                            \
  template float spectral_radius(const SymmetricBlocks<B>&); \
  template void invert_diagonal(SymmetricBlocks<B>&, Index);
FRICTIONCG_BLOCKS(FRICTIONCG_INSTANTIATE)
#undef FRICTIONCG_INSTANTIATE

}  // namespace frictioncg
