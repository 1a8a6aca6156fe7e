#pragma once
#include "types.h"

namespace frictioncg {

// The decompositions of dense matrices, each compiled once: where they are used, Eigen's templates
// cost the compiler seconds.
using DenseRef = Eigen::Ref<const DenseMatrix>;

/// The X of least norm among those that make |AX - B| least. Of A, what is below `threshold` of the
/// largest pivot is 0; a threshold of 0: below rounding. rank: of what is left, where it is asked
/// for.
DenseMatrix least_squares(const DenseRef& A, const DenseRef& B, Real threshold = 0,
                          Index* rank = nullptr);
/// A^{-1} B by elimination with complete pivoting, accurate where the rows of A differ in size.
/// What rounding may have made of a singular A is 0.
DenseMatrix solve(const DenseRef& A, const DenseRef& B);

/// A v = lambda v, or A v = lambda M v with v'Mv = 1; A symmetric, M positive definite.
struct Eigenpairs {
  Vector values;        ///< in ascending order
  DenseMatrix vectors;  ///< columns
};
Eigenpairs eigenpairs(const DenseRef& A);
Eigenpairs eigenpairs(const DenseRef& A, const DenseRef& M);

/// R of A = QR, k x k, with rows of 0 where A (m x k) has fewer than k.
DenseMatrix triangle(const DenseRef& A);
/// Q of A = QR, m x k: an orthonormal basis of what the columns span, m >= k.
DenseMatrix orthonormal(const DenseRef& A);
/// An orthonormal basis of the v with |Av| <= tolerance |v|.
DenseMatrix null_space(const DenseRef& A, Real tolerance);

/// Some p with p'Mp < 0, of M symmetric; empty where the pivots of Cholesky's method show none.
Vector negative_direction(DenseMatrix M);

}  // namespace frictioncg
