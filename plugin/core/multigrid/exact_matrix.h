#pragma once
#include "multigrid/block_matrix.h"
#include "multigrid/node_blocks.h"

namespace frictioncg {

/// A in double precision at the places of a level's blocks, one half of it: a product reads half of
/// what a matrix with both halves takes, and next to no indices. Filled where it is made.
template <int D>
class ExactMatrix {
 public:
  std::vector<Real> lower;     ///< D x D for each stored block
  std::vector<Real> diagonal;  ///< D x D for each row

  /// Ax = A x, where `slot` (n) tells the place of each dof; false where A is not kept.
  bool multiply(const SymmetricBlocks<D>& places, const std::vector<Index>& slot, const Vector& x,
                Vector& Ax);
  /// Drops all where the other half of A differs by more than rounding, which a product tells.
  void keep_if_symmetric(const Matrix& A, const SymmetricBlocks<D>& places,
                         const std::vector<Index>& slot);
  double bytes() const {
    return bytes_of(lower, diagonal) + sizeof(Real) * double(x_.size() + y_.size());
  }

 private:
  Vector x_, y_;  ///< by slots
};

/// factor A by blocks of mesh nodes, in single precision, and A at the same places; empty slots
/// have empty rows.
template <int D>
SymmetricBlocks<D> make_fine_matrix(const Matrix& A, const NodeBlocks& blocks, Real factor,
                                    ExactMatrix<D>& exact);

}  // namespace frictioncg
