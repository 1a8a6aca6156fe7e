#include "multigrid/level.h"

#include "multigrid/galerkin.h"

namespace frictioncg {

namespace {

/// So many power steps tell the spectral radius, from below, to some percent: the damping stays
/// stable with that.
constexpr int power_steps = 8;
/// The prolongation is smoothed by a Jacobi step of this over the spectral radius, the usual
/// choice.
constexpr float damping = 4.0f / 3;
/// A level keeps so many vectors beside its matrices.
constexpr int vectors = 6;

template <class T>
double bytes_of(const std::vector<T>& v) {
  return double(v.capacity()) * sizeof(T);
}

}  // namespace

template <int B, int K>
double Level<B, K>::bytes() const {
  return bytes_of(A.row) + bytes_of(A.col) + bytes_of(A.value) + bytes_of(A.diagonal) +
         bytes_of(A.inverse) + bytes_of(P.row) + bytes_of(P.col) + bytes_of(P.value) +
         bytes_of(touched.lower) + bytes_of(base) + vectors * bytes_of(r) + border.bytes();
}

template <int B, int K>
Modes<K> coarsen(Level<B, K>& level, const Modes<K>& modes, Coarsening how) {
  const BlockGraph graph = make_graph(level.A);
  const Aggregates aggregates = aggregate(graph, coupling_strength(level.A), how);
  const Tentative<B, K> tentative = make_tentative<B, K>(aggregates, modes);
  const float omega = damping / spectral_radius(level.A, power_steps);
  level.P = smooth<B, K>(level.A, graph, aggregates, tentative.value, omega);
  return tentative.coarse;
}

template <int B, int K>
void make_next(Level<B, K>& level, Level<K, K>& next, std::vector<float>& contact) {
  next.A = galerkin_pattern(level.A, level.P);
  next.touched = Touched<K>::reached(level.A, level.touched, level.P, next.A);
  GalerkinProduct<B, K> product;
  level.touched.add(0, level.base, level.A);
  product.add(level.A, level.P, next.A);
  next.base = next.touched.read(next.A);

  level.touched.add(0, contact, level.A);
  next.touched.clear(next.A);
  product.add(level.A, level.P, level.touched, next.A);
  level.touched.add(1, level.base, level.A);
  contact = next.touched.read(next.A);
  next.touched.add(1, next.base, next.A);
  for (Index i = 0; i < next.A.rows(); ++i) invert_diagonal(next.A, i);
  next.allocate();
}

#define FRICTIONCG_INSTANTIATE(B, K)                                    \
  template double Level<B, K>::bytes() const;                           \
  template Modes<K> coarsen(Level<B, K>&, const Modes<K>&, Coarsening); \
  template void make_next(Level<B, K>&, Level<K, K>&, std::vector<float>&);
FRICTIONCG_PROLONGATIONS(FRICTIONCG_INSTANTIATE)
#undef FRICTIONCG_INSTANTIATE

}  // namespace frictioncg
