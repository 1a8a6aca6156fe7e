#pragma once
#include "condensed/ordering.h"

namespace frictioncg {

/// Rows of A up to the diagonal: by columns, the upper triangle that CHOLMOD reads.
struct UpperTriangle {
  std::vector<Index> column, row;
  std::vector<Real> value;
  cholmod_sparse view{};

  /// Entries that are there, zero if need be: of the dofs that are chained, next to the diagonal;
  /// in the column of the first contact dof, those of the roots.
  UpperTriangle(const System& system, const std::vector<char>& chained,
                const std::vector<Index>& roots = {});
  Real& diagonal(Index j) { return value[column[j + 1] - 1]; }
};

/// A session of CHOLMOD, and in it one factor L L' of a matrix in an order that is given.
class SparseFactor {
 protected:
  explicit SparseFactor(int supernodal);
  ~SparseFactor();
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;

  /// Lays out the factor. False where it is too large for CHOLMOD, which indexes it by 32 bits.
  bool lay_out(cholmod_sparse& view, const std::vector<Index>& order);
  /// Fills it. False where a pivot is not positive, which L_->minor names.
  bool factorize(cholmod_sparse& view);
  Vector solve(int triangle, const Vector& rhs);
  void release();
  /// Whether threads of the BLAS are worth their CPU time.
  bool threads_pay() const;

  cholmod_common common_;
  cholmod_factor* L_ = nullptr;

 private:
  cholmod_dense *X_ = nullptr, *Y_ = nullptr, *E_ = nullptr;  ///< kept by cholmod_solve2
};

}  // namespace frictioncg
