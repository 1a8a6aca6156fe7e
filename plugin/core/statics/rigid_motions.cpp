#include "statics/rigid_motions.h"

#include "factorization.h"
#include "linear_algebra.h"

namespace frictioncg {

namespace {

constexpr Real rounding_of_S = 1e3;  ///< over that of A: S is a difference of matrices of size D
constexpr Real first_shift = 1e-9;   ///< of inverse iteration, relative to D
constexpr Real greatest_shift = 1e-5;
constexpr int sweeps = 8;         ///< of inverse iteration: a softest mode of 1e-8 D is out by then
constexpr Index first_block = 7;  ///< one more than a single body has

/// Columns without structure, so that they have a part along every motion.
DenseMatrix arbitrary(Index n, Index columns) {
  return DenseMatrix::NullaryExpr(n, columns, [](Index i, Index j) {
    const Real t = std::sin(12.9898 * (i + 1) + 78.233 * (j + 1)) * 43758.5453;
    return t - std::floor(t) - 0.5;
  });
}

}  // namespace

DenseMatrix rigid_motions(const DenseMatrix& S, const Vector& D) {
  const Index n = static_cast<Index>(S.rows());
  if (n == 0) return DenseMatrix(0, 0);
  const Vector scale = D.cwiseSqrt().cwiseInverse();
  for (Real shift = first_shift; shift <= greatest_shift; shift *= 100) {
    DenseMatrix M = scale.asDiagonal() * S * scale.asDiagonal();
    M.diagonal().array() += shift;
    const Cholesky factor(M);
    if (!factor.found()) continue;
    for (Index block = std::min(n, first_block);; block = std::min(n, 2 * block)) {
      DenseMatrix W = arbitrary(n, block);
      for (int k = 0; k < sweeps; ++k) W = orthonormal(factor.solve(W));
      const DenseMatrix V = scale.asDiagonal() * W;
      const Eigenpairs ritz = eigenpairs(V.transpose() * (S * V));
      Index count = 0;
      while (count < block && costs_no_energy(ritz.values[count], 1, rounding_of_S)) ++count;
      if (count == block && block < n) continue;
      return V * ritz.vectors.leftCols(count);
    }
  }
  return DenseMatrix(n, 0);
}

/// By t x (x x t) = x - t t'x: along an axis e_k, a dof that moves along t tells 1 - t_k^2 of x_k.
Eigen::MatrixXd places_of(const std::vector<Index>& mesh_node, int dimension,
                          const Eigen::MatrixXd& modes) {
  const Index nodes = 1 + *std::max_element(mesh_node.begin(), mesh_node.end());
  Eigen::MatrixXd place = Eigen::MatrixXd::Zero(nodes, dimension), told = place;
  for (std::size_t i = 0; i < mesh_node.size(); ++i) {
    Vec3 t = Vec3::Zero(), x_t = Vec3::Zero();
    t.head(dimension) = modes.row(Index(i)).head(dimension);
    x_t.tail(modes.cols() - dimension) = modes.row(Index(i)).tail(modes.cols() - dimension);
    place.row(mesh_node[i]) += t.cross(x_t).head(dimension);
    told.row(mesh_node[i]).array() +=
        t.head(dimension).squaredNorm() - t.head(dimension).array().square().transpose();
  }
  return (told.array() > 0).select(place.array() / told.array(), 0);
}

}  // namespace frictioncg
