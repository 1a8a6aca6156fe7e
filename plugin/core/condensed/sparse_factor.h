#pragma once
#include <cholmod.h>

#include "model/system.h"

namespace frictioncg {

/// A permutation of the dofs (n) with little fill-in, the contact dofs last and in their order: in
/// 2D minimum degree with the contact dofs as the last class, in 3D nested dissection of the
/// interior. Both work on the graph of the mesh nodes, whose d dofs stay together: d^2 times fewer
/// edges than between dofs.
///
/// On blocks (2D to 800 k dofs, 3D to 100 k) minimum degree takes 0.7 of CHOLMOD's best plain solve
/// in 2D but 1.6 in 3D, nested dissection 0.9 and 1.1; minimum degree of the interior alone fills
/// more than either. Empty where the graph is too large for CHOLMOD, as below.
std::vector<Index> contact_last(const System& system, cholmod_common& common);

/// A permutation of the dofs (n) with little fill-in, those of a mesh node together: minimum
/// degree.
std::vector<Index> by_nodes(const System& system, cholmod_common& common);

/// In each connected part of the interior, the dof that `order` eliminates last: the root of its
/// tree.
std::vector<Index> last_of_each_part(const System& system, const std::vector<Index>& order);

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
