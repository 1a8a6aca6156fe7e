#include "assembly/axisymmetry.h"

namespace frictioncg {

namespace {

/// The sum of a row vanishes where it is below this share of the entries: rounding leaves 1e-15 of
/// them, rings leave (h/r)^2.
constexpr Real noise = 1e-11;
/// A row whose sum is above this share of its entries is passed over: it is a Dirichlet condition,
/// or next to nothing but mass.
constexpr Real alone = 0.99;

}  // namespace

int radial_component(const Triplets& A, const std::vector<Index>& node) {
  std::vector<Index> component(A.n, 0);
  for (Index i = 1; i < A.n; ++i)
    if (node[i] == node[i - 1]) component[i] = component[i - 1] + 1;
  // what translations meet in a row, along the dof's own component, and along the other one
  std::array<Vector, 2> sum{Vector::Zero(A.n), Vector::Zero(A.n)}, size = sum;
  for_each_entry(A, [&](Index i, Index j, Real a) {
    const int along = component[i] == component[j] ? 0 : 1;
    sum[along][i] += a;
    size[along][i] += std::abs(a);
  });
  Index nodes = 0, strained[2] = {0, 0};
  bool pressed[2] = {false, false};  // by a translation along the component
  for (Index i = 0; i + 1 < A.n; ++i) {
    if (component[i] != 0 || component[i + 1] != 1) continue;
    for (int c : {0, 1})
      if (std::abs(sum[1][i + 1 - c]) > noise * size[1][i + 1 - c]) pressed[c] = true;
    const Real x = sum[0][i], y = sum[0][i + 1];
    if (x > alone * size[0][i] || y > alone * size[0][i + 1]) continue;
    ++nodes;
    const Real least = noise * (size[0][i] + size[0][i + 1]);
    if (x - y > least) ++strained[0];
    if (y - x > least) ++strained[1];
  }
  for (int c : {0, 1})
    if (2 * strained[c] > nodes && pressed[c]) return c;
  return -1;
}

}  // namespace frictioncg
