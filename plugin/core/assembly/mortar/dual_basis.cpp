#include "assembly/mortar/dual_basis.h"

#include "linear_algebra.h"

namespace frictioncg::mortar {

DualBasis dual_basis(int d, const Eigen::Matrix3d& M, const std::array<bool, 3>& kept) {
  DualBasis basis;
  std::array<int, 3> K{};
  int size = 0;
  for (int v = 0; v < d; ++v)
    if (kept[v]) K[size++] = v;
  if (size == 0) return basis;
  Eigen::MatrixXd chi = Eigen::MatrixXd::Zero(size, d), X(size, size);
  for (int j = 0; j < size; ++j)
    for (int v = 0; v < d; ++v) chi(j, v) = v == K[j] ? 1 : kept[v] ? 0 : 1. / size;
  for (int j = 0; j < size; ++j)
    for (int k = 0; k < size; ++k) X(j, k) = chi.row(j).dot(M.col(K[k]).head(d));
  const DenseMatrix coefficients = solve(X, chi);
  for (int i = 0; i < size; ++i) {
    basis.d[K[i]] = M.col(K[i]).sum();
    basis.psi.row(K[i]).head(d) = basis.d[K[i]] * coefficients.row(i);
  }
  return basis;
}

}  // namespace frictioncg::mortar
