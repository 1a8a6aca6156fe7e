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

}  // namespace frictioncg
