#include "statics/floating.h"

#include "factorization.h"
#include "linear_algebra.h"
#include "model/rigid_candidates.h"

namespace frictioncg {

namespace {

constexpr Real made_up = 1e-13;      ///< of the largest <Dw,w>: a candidate that the others make up
constexpr Real nearly_rigid = 1e-6;  ///< <Aw,w>/<Dw,w>, with what rounding leaves of small bodies
/// What is left of a motion beside rigid ones, over all of it: rounding makes 1e-8, and the bending
/// of a body that its supports hold a tenth and more.
constexpr Real bent = 1e-3;
constexpr Real still = 1e-10;  ///< over the largest displacement: what does not move

/// The motions of one body: combinations (k x j) of the candidates, from their Gram matrices in A
/// and D. Those nearly in the kernel, <Dw,w> = 1. size_of_all: below its rounding a candidate is 0.
DenseMatrix candidates_of_a_body(const DenseMatrix& in_A, const DenseMatrix& in_D,
                                 Real size_of_all) {
  const Index k = static_cast<Index>(in_D.cols());
  if (k == 0) return in_D;
  const Eigenpairs sizes = eigenpairs(in_D);
  const Vector& size = sizes.values;
  Index first = 0;
  const Real least = made_up * std::max(size[k - 1], size_of_all);
  while (first < k && !(size[first] > least)) ++first;
  const DenseMatrix V = sizes.vectors.rightCols(k - first) *
                        size.tail(k - first).cwiseSqrt().cwiseInverse().asDiagonal();
  if (V.cols() == 0) return V;
  const Eigenpairs ritz = eigenpairs(V.transpose() * DenseMatrix(in_A * V));
  Index count = 0;
  while (count < V.cols() && ritz.values[count] <= nearly_rigid) ++count;
  return V * ritz.vectors.leftCols(count);
}

/// Row by row the candidates times the combinations c of the row's body.
Matrix combined(const RigidCandidates& all, const std::vector<Matrix>& c) {
  Index most = 0;
  for (const Matrix& of_body : c) most = std::max(most, Index(of_body.cols()));
  Matrix T(all.M.rows(), most);
  Vector sum = Vector::Zero(most);
  std::set<Index> columns;
  for (Index i = 0; i < T.rows(); ++i) {
    const Index body = all.bodies.of[i];
    for (Matrix::InnerIterator m(all.M, i); m; ++m)
      for (Matrix::InnerIterator x(c[body], all.place(body, Index(m.col()))); x; ++x) {
        sum[x.col()] += m.value() * x.value();
        columns.insert(Index(x.col()));
      }
    T.startVec(i);
    for (Index j : columns) T.insertBack(i, j) = std::exchange(sum[j], 0);
    columns.clear();
  }
  T.finalize();
  return T;
}

/// c: combinations of each body, as columns over its own candidates. Adds those that are rigid
/// motions to W (n x k), <Dw,w> = 1, and says which they are. Bodies share no entry of A: one
/// product tries a combination of each.
std::vector<std::vector<Index>> add_rigid(const System& system, const RigidCandidates& all,
                                          const std::vector<Matrix>& c, DenseMatrix& W) {
  std::vector<std::vector<Index>> accepted(c.size());
  const Matrix T = combined(all, c);
  if (T.cols() == 0) return accepted;
  DenseMatrix size = DenseMatrix::Zero(T.cols(), all.bodies.count), energy = size;
  system.product(T, [&](Index i, const std::vector<Index>&, const Vector& AT) {
    const Index body = all.bodies.of[i];
    for (Matrix::InnerIterator t(T, i); t; ++t) {
      size(t.col(), body) += system.D[i] * t.value() * t.value();
      energy(t.col(), body) += t.value() * AT[t.col()];
    }
  });
  system.sum(size.data(), Index(size.size()));
  system.sum(energy.data(), Index(energy.size()));
  Eigen::MatrixXi column = Eigen::MatrixXi::Constant(T.cols(), all.bodies.count, -1);
  const Index before = Index(W.cols());
  Index after = before;
  for (Index body = 0; body < all.bodies.count; ++body)
    for (Index j = 0; j < Index(c[body].cols()); ++j) {
      if (!(size(j, body) > 0) || !costs_no_energy(energy(j, body), size(j, body))) continue;
      column(j, body) = after++;
      accepted[body].push_back(j);
    }
  W.conservativeResize(Eigen::NoChange, after);
  W.rightCols(after - before).setZero();
  for (Index i = 0; i < W.rows(); ++i)
    for (Matrix::InnerIterator t(T, i); t; ++t) {
      const Index body = all.bodies.of[i], k = column(t.col(), body);
      if (k >= 0) W(i, k) = t.value() / std::sqrt(size(t.col(), body));
    }
  return accepted;
}

/// Of one body of A: of each group of `each` candidates, the motions that it makes alone.
Matrix alone(const std::vector<Index>& candidates, Index each, const DenseMatrix& in_A,
             const DenseMatrix& in_D) {
  EntryList entries;
  const Index k = Index(candidates.size());
  Index count = 0;
  for (Index first = 0, end; first < k; first = end) {
    for (end = first; end < k && candidates[end] / each == candidates[first] / each;) ++end;
    const Index size = end - first;
    const DenseMatrix own = candidates_of_a_body(in_A.block(first, first, size, size),
                                                 in_D.block(first, first, size, size), 0);
    for (Index j = 0; j < Index(own.cols()); ++j, ++count)
      for (Index i = 0; i < size; ++i) entries.emplace_back(first + i, count, own(i, j));
  }
  return sparse(k, count, entries);
}

/// What is left of candidates beside motions V (k x v), in the product of D; those of groups that V
/// moves in every way are left out.
DenseMatrix beside(const Matrix& V, const std::vector<Index>& candidates, Index each,
                   const DenseMatrix& in_D) {
  std::map<Index, std::set<Index>> moved;  // by V, of each group
  for (Index i = 0; i < Index(V.rows()); ++i)
    for (Matrix::InnerIterator v(V, i); v; ++v) moved[candidates[i] / each].insert(Index(v.col()));
  std::vector<Index> left;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (Index(moved[candidates[i] / each].size()) < each) left.push_back(Index(i));
  const Index k = Index(candidates.size());
  DenseMatrix rest = DenseMatrix::Zero(k, Index(left.size()));
  for (std::size_t j = 0; j < left.size(); ++j) rest(left[j], Index(j)) = 1;
  if (V.cols() == 0 || left.empty()) return rest;
  const DenseMatrix in_V = V.transpose() * in_D;  // v x k
  DenseMatrix size = in_V * V;
  const DenseMatrix along = in_V(Eigen::all, left);
  const DenseMatrix kept = size;
  const Cholesky factor(size);
  return rest - V * (factor.found() ? factor.solve(along) : least_squares(kept, along));
}

}  // namespace

DenseMatrix floating_motions(const System& system) {
  const RigidCandidates all(system);
  DenseMatrix W(system.dofs(), 0);
  if (all.count() == 0) return W;
  const auto of_A = [&](const auto& visit) {
    system.product(all.M, [&](Index i, const std::vector<Index>& columns, const Vector& values) {
      for (Index j : columns) visit(i, j, values[j]);
    });
  };
  const std::vector<DenseMatrix> in_A = all.gram(of_A), in_D = all.gram_in(system.D);
  const Index each = rigid_components(system.dimension);
  // first those of each candidate's body alone: beside a stiff body that a coupling joins to it in
  // A, what rounding leaves of a soft one would blur them
  std::vector<Matrix> c(all.bodies.count);
  for (Index body = 0; body < all.bodies.count; ++body) {
    const std::vector<Index>& own = all.of_body[body];
    c[body] = each < all.count() ? alone(own, each, in_A[body], in_D[body])
                                 : Matrix(Index(own.size()), 0);
  }
  const std::vector<std::vector<Index>> accepted = add_rigid(system, all, c, W);
  // then what is left in common
  for (Index body = 0; body < all.bodies.count; ++body) {
    EntryList kept;
    for (Index j : accepted[body]) kept.emplace_back(j, Index(kept.size()), 1);
    const Matrix V = c[body] * sparse(Index(c[body].cols()), Index(kept.size()), kept);
    const DenseMatrix R = beside(V, all.of_body[body], each, in_D[body]);
    c[body] = (R * candidates_of_a_body(R.transpose() * in_A[body] * R,
                                        R.transpose() * in_D[body] * R, in_D[body].trace()))
                  .sparseView();
  }
  add_rigid(system, all, c, W);
  return W;
}

/// In the product of D soft parts would not count, whose bending is what lets stiff ones move.
bool may_be_rigid(const System& system, const Vector& w) {
  const RigidCandidates all(system);
  if (all.count() == 0) return true;
  const Real rest = (w - all.nearest_to(w)).squaredNorm();
  return system.sum(rest) <= bent * bent * system.sum(w.squaredNorm());
}

DenseMatrix motions_of_interior(const DenseMatrix& W, Index interior) {
  const Index n = static_cast<Index>(W.rows());
  if (W.cols() == 0 || interior == n) return W;
  DenseMatrix Z = W * null_space(W.bottomRows(n - interior), still * W.cwiseAbs().maxCoeff());
  Z.bottomRows(n - interior).setZero();
  return Z;
}

std::vector<Index> telling_rows(DenseMatrix Z) {
  std::vector<Index> rows;
  for (Index j = 0; j < static_cast<Index>(Z.cols()); ++j) {
    for (Index k = 0; k < j; ++k) {
      const Real part = Z(rows[k], j) / Z(rows[k], k);
      if (part != 0) Z.col(j) -= part * Z.col(k);
    }
    Index row;
    if (!(Z.col(j).cwiseAbs().maxCoeff(&row) > 0)) return {};
    rows.push_back(row);
  }
  return rows;
}

DenseMatrix one_for_each(const std::vector<Index>& units, const DenseMatrix& Z) {
  const Index n = static_cast<Index>(Z.rows()), count = static_cast<Index>(units.size());
  if (count == 0 || Z.cols() != count) return DenseMatrix(n, 0);
  DenseMatrix at_units(count, count);
  for (Index j = 0; j < count; ++j) at_units.row(j) = Z.row(units[j]);
  const DenseMatrix I = DenseMatrix::Identity(count, count), inverse = solve(at_units, I);
  const bool regular = (at_units * inverse - I).norm() < 0.5;  // of fewer dimensions: 1 and more
  return regular ? DenseMatrix(Z * inverse) : DenseMatrix(n, 0);
}

}  // namespace frictioncg
