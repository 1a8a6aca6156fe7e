#include "assembly/basis.h"

namespace frictioncg {

Images::Images(const Basis& basis) : plain(basis.T.rows(), -1), all(basis.T.rows()) {
  const auto [row, col, a] = arrays_of(basis.T);
  for (Index i = 0; i < basis.T.rows(); ++i) {
    if (row[i + 1] != row[i] + 1) continue;
    const Index image = col[row[i]];
    const Real factor = a[row[i]];
    all[i] = {image, factor};
    if (factor == 1 && image < basis.local_dofs()) plain[i] = image;
  }
}

Basis composed(const Coupling& coupling, const Basis& of_v) {
  Basis of_u = of_v;
  of_u.T = coupling.T * of_v.T;
  of_u.W = of_v.W * coupling.W;
  of_u.rotated = of_v.rotated || coupling.T.nonZeros() > coupling.T.rows();
  return of_u;
}

}  // namespace frictioncg
