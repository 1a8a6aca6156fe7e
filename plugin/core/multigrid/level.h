#pragma once
#include "multigrid/galerkin.h"

namespace frictioncg {

/// The rows of k unknowns q beside those of a level, [A B; B' S]: they are at no place, and the
/// same on all levels. Few blocks of R rows of B are not 0.
template <int R>
struct LevelBorder {
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<Index> block;  ///< those that are not 0
  Rows B;                    ///< their rows, R a block, by k
  Vector r, z;               ///< k
  Vector first_r, first_z;   ///< of the first of two cycles

  /// v -= B q
  void subtract(const Vector& q, float* v) const {
    for (std::size_t b = 0; b < block.size(); ++b)
      Eigen::Map<Eigen::Matrix<float, R, 1>>(v + std::size_t(block[b]) * stride<R>) -=
          B.template middleRows<R>(Eigen::Index(b) * R)
              .template cast<Real>()
              .lazyProduct(q)
              .template cast<float>();
  }
  /// q -= B' v
  void subtract_transposed(const float* v, Vector& q) const {
    for (std::size_t b = 0; b < block.size(); ++b)
      for (int s = 0; s < R; ++s)
        q -= Real(v[std::size_t(block[b]) * stride<R> + s]) *
             B.row(Eigen::Index(b) * R + s).transpose().template cast<Real>();
  }
  void allocate(Eigen::Index k) {
    for (Vector* q : {&r, &z, &first_r, &first_z}) q->setZero(k);
  }
};

/// coarse.B = P' fine.B
template <int R, int C>
void restrict_border(const Prolongation<R, C>& P, const LevelBorder<R>& fine,
                     LevelBorder<C>& coarse) {
  std::vector<Index> at(P.columns, -1);
  coarse.block.clear();
  for (const Index i : fine.block)
    for (Index q = P.row[i]; q < P.row[i + 1]; ++q) {
      if (at[P.col[q]] >= 0) continue;
      at[P.col[q]] = static_cast<Index>(coarse.block.size());
      coarse.block.push_back(P.col[q]);
    }
  coarse.B.setZero(Eigen::Index(coarse.block.size()) * C, fine.B.cols());
  for (std::size_t b = 0; b < fine.block.size(); ++b)
    for (Index q = P.row[fine.block[b]]; q < P.row[fine.block[b] + 1]; ++q) {
      const Eigen::Map<const Eigen::Matrix<float, R, C, Eigen::RowMajor>> p(P.at(q));
      coarse.B.template middleRows<C>(Eigen::Index(at[P.col[q]]) * C) +=
          p.transpose().lazyProduct(fine.B.template middleRows<R>(Eigen::Index(b) * R));
    }
}

/// One level of a hierarchy with B slots a row; the next one has K.
template <int B, int K>
struct Level {
  SymmetricBlocks<B> A;
  Prolongation<B, K> P;     ///< from the next level; none on the coarsest
  Touched<B> touched;       ///< blocks that the contact dofs contribute to
  std::vector<float> base;  ///< of the touched blocks, what the interior gives them
  std::vector<float> r, z, work, residual;
  std::vector<float> first_r, first_z;  ///< of the first of two cycles
  LevelBorder<B> border;

  void allocate() {
    for (std::vector<float>* v : {&r, &z, &work, &residual, &first_r, &first_z})
      v->assign(std::size_t(A.rows()) * stride<B>, 0);
  }

  /// Builds P by smoothed aggregation; returns the grid of the next level. Thin layers of elements
  /// are not aggregated across.
  Grid<K> coarsen(const Modes<K>& modes, const Eigen::MatrixXd& place, Coarsening how) {
    // the Jacobi step that smooths P, over the spectral radius: the usual choice
    constexpr float damping = 4.0f / 3;
    const BlockGraph graph = make_graph(A);
    const Aggregates aggregates = aggregate(graph, coupling_strength(A), how);
    const Tentative<B, K> tentative = make_tentative<B, K>(aggregates, modes);
    const float omega = damping / spectral_radius(A);
    P = smooth<B, K>(A, graph, aggregates, tentative.value, omega);
    Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(aggregates.count, place.cols());
    Vector members = Vector::Zero(aggregates.count);
    for (Index i = 0; i < A.rows(); ++i) {
      middle.row(aggregates.of[i]) += place.row(i);
      ++members[aggregates.of[i]];
    }
    return {tentative.coarse, members.cwiseInverse().asDiagonal() * middle};
  }

  /// next.A = P' A P, its base apart: A holds its own base in turn, and then, in the touched
  /// blocks, the contact part alone. contact: that part of A, replaced by that of next.A. The rows
  /// of `grid` and the columns of P are renumbered for threads.
  void make_next(Level<K, K>& next, Grid<K>& grid, std::vector<float>& contact) {
    const Touched<B> all = Touched<B>::all(A);
    std::vector<Index> number;
    next.A = galerkin_pattern(A, all, P, grid.place, number);
    for (Index& column : P.col) column = number[column];
    grid.renumber(number);
    next.touched = touched.reached(A, P, next.A);
    GalerkinProduct<B, K> product;
    touched.add(0, base, A);
    product.add(A, P, all, next.A);
    next.base = next.touched.read(next.A);

    touched.add(0, contact, A);
    restrict_touched(product, next);
    touched.add(1, base, A);
    contact = next.touched.read(next.A);
    next.touched.add(1, next.base, next.A);
    for (Index i = 0; i < next.A.rows(); ++i) invert_diagonal(next.A, i);
    next.allocate();
  }

  /// What is not 0 but in touched blocks: those of next.A, without their base, and the border.
  void restrict_touched(GalerkinProduct<B, K>& product, Level<K, K>& next) const {
    next.touched.clear(next.A);
    product.add(A, P, touched, next.A);
    restrict_border(P, border, next.border);
  }

  double bytes() const {
    return bytes_of(A.row, A.col, A.value, A.diagonal, A.inverse, P.row, P.col, P.value,
                    touched.lower, base, r, z, work, residual, first_r, first_z, border.block) +
           sizeof(float) * double(border.B.size());
  }
};

}  // namespace frictioncg
