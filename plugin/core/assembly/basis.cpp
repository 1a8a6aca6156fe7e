#include "assembly/basis.h"

namespace frictioncg {

std::vector<Image> images(const Basis& basis) {
  const Index* row = basis.T.outerIndexPtr();
  std::vector<Image> all(basis.T.rows());
  for (Index i = 0; i < basis.T.rows(); ++i)
    if (row[i + 1] == row[i] + 1)
      all[i] = {basis.T.innerIndexPtr()[row[i]], basis.T.valuePtr()[row[i]]};
  return all;
}

Basis composed(const Coupling& coupling, const Basis& of_v) {
  Basis of_u = of_v;
  of_u.T = coupling.T * of_v.T;
  of_u.W = of_v.W * coupling.W;
  of_u.rotated = of_v.rotated || coupling.T.nonZeros() > coupling.T.rows();
  return of_u;
}

}  // namespace frictioncg
