#include "model/inertia.h"

#include "linear_algebra.h"
#include "model/contact_problem.h"

namespace frictioncg {

namespace {

/// Forces of a rigid motion below this, over diag(A) and the motion, are rounding.
constexpr Real no_resistance = 1e-12;

/// Whether A resists the motion w at more than half of the dofs.
bool resists_everywhere(const System& system, const Vector& w) {
  Vector Aw;
  system.multiply(w, Aw);
  const Real size = system.largest(w.lpNorm<Eigen::Infinity>());
  const Index count = (Aw.array().abs() > no_resistance * size * system.D.array()).count();
  return system.sum(2.0 * count - system.dofs()) > 0;
}

/// The same motions, each of one body alone.
Matrix of_each_body(const System& system, const DenseMatrix& motions) {
  const Bodies bodies = system.bodies();
  const Index k = static_cast<Index>(motions.cols());
  EntryList entries;
  for (Index i = 0; i < system.dofs(); ++i)
    for (Index j = 0; j < k; ++j)
      if (motions(i, j) != 0) entries.emplace_back(i, bodies.of[i] * k + j, motions(i, j));
  return sparse(system.dofs(), bodies.count * k, entries);
}

/// The columns that share rows, on any process, by the first of them: of bodies that A does not
/// couple, as there are many where masses are lumped, each has its own.   products: of columns, by
/// the rows of this process
std::map<Index, std::vector<Index>> joined_columns(const System& system, const Matrix& products) {
  const Index count = static_cast<Index>(products.cols());
  Groups here(count), groups(count);
  for (Index c = 0; c < count; ++c)
    for (Matrix::InnerIterator e(products, c); e; ++e) here.join(c, Index(e.col()));
  Vector roots(count);
  for (Index c = 0; c < count; ++c) roots[c] = here.of(c);
  const Vector all = system.gathered(roots);
  for (Index k = 0; k < all.size(); ++k) groups.join(k % count, Index(all[k]));
  std::map<Index, std::vector<Index>> joined;
  for (Index c = 0; c < count; ++c) joined[groups.of(c)].push_back(c);
  return joined;
}

}  // namespace

Matrix inertia_of(const System& system) {
  // Away from turned frames this is a translation, and far cheaper than the motions.
  if (!resists_everywhere(system, Vector::Ones(system.dofs()))) return {};
  const DenseMatrix motions = system.rigid_modes ? system.rigid_modes() : DenseMatrix();
  if (system.largest(motions.rows() == system.dofs()) == 0) return {};
  Vector some(motions.cols());  // a sum of all of them
  for (Index k = 0; k < some.size(); ++k) some[k] = 1 / (1 + 0.3 * k);
  if (!resists_everywhere(system, motions.lazyProduct(some))) return {};
  const Matrix W = system.body_modes ? system.body_modes() : of_each_body(system, motions);
  EntryList entries;
  system.product(W, [&](Index i, const std::vector<Index>& columns, const Vector& values) {
    for (Index j : columns) entries.emplace_back(i, j, values[j]);
  });
  return sparse(system.dofs(), Index(W.cols()), entries);
}

Real load_beside_inertia(const System& system, const Vector& b) {
  const Matrix& AW = system.inertia;
  if (AW.cols() == 0) return norm_D(system, b);
  const Vector weight = system.weight.cwiseInverse();
  const Matrix weighted = weight.asDiagonal() * AW, sizes = AW.transpose() * weighted;
  Vector part = weighted.transpose() * b;
  system.sum(part.data(), static_cast<Index>(part.size()));
  Vector along(part.size());
  for (const auto& [first, columns] : joined_columns(system, sizes)) {
    DenseMatrix of_columns(columns.size(), columns.size());
    for (std::size_t k = 0; k < columns.size(); ++k)
      for (std::size_t l = 0; l < columns.size(); ++l)
        of_columns(k, l) = sizes.coeff(columns[k], columns[l]);
    system.sum(of_columns.data(), static_cast<Index>(of_columns.size()));
    along(columns) = least_squares(of_columns, part(columns));
  }
  return norm_D(system, b - AW * along);
}

}  // namespace frictioncg
