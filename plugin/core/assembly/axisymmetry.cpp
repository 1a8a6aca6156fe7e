#include "assembly/axisymmetry.h"

namespace frictioncg {

namespace {

/// The sum of a row vanishes where it is below this share of the entries: rounding leaves 1e-15 of
/// them, rings leave (h/r)^2.
constexpr Real noise = 1e-11;
/// A row whose sum is above this share of its entries is passed over: it is a Dirichlet condition,
/// or next to nothing but mass.
constexpr Real alone = 0.99;

/// What a translation along one component meets in a row.
struct Row {
  Real sum = 0, size = 0;
  void add(Real a) {
    sum += a;
    size += std::abs(a);
  }
};

}  // namespace

int radial_component(const Triplets& A, const std::vector<Index>& node) {
  std::vector<Index> component(A.n, 0);
  for (Index i = 1; i < A.n; ++i)
    if (node[i] == node[i - 1]) component[i] = component[i - 1] + 1;
  std::vector<Row> rows(A.n), other(A.n);  // along the dof's own component, and the other one
  for_each_entry(A, [&](Index i, Index j, Real a) {
    (component[i] == component[j] ? rows : other)[i].add(a);
  });
  Index nodes = 0, strained[2] = {0, 0};
  bool pressed[2] = {false, false};  // by a translation along the component
  for (Index i = 0; i + 1 < A.n; ++i) {
    if (component[i] != 0 || component[i + 1] != 1) continue;
    const Row &x = rows[i], &y = rows[i + 1];
    for (int c : {0, 1}) {
      const Row& across = other[i + 1 - c];
      if (std::abs(across.sum) > noise * across.size) pressed[c] = true;
    }
    if (x.sum > alone * x.size || y.sum > alone * y.size) continue;
    ++nodes;
    if (x.sum - y.sum > noise * (x.size + y.size)) ++strained[0];
    if (y.sum - x.sum > noise * (x.size + y.size)) ++strained[1];
  }
  for (int c : {0, 1})
    if (2 * strained[c] > nodes && pressed[c]) return c;
  return -1;
}

}  // namespace frictioncg
