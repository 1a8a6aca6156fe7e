#include "statics/uncertain_work.h"

#include "linear_algebra.h"

namespace frictioncg {

Real leave_out_uncertain_work(const System& system, const DenseMatrix& W, Real told, Vector& F) {
  constexpr Real rounding = 1e-13;  // of squares of n.w, over those of the motion most resisted
  const Index k = static_cast<Index>(W.cols());
  if (k == 0 || told <= 0) return 0;
  DenseMatrix Q = DenseMatrix::Zero(k, k);
  for (Index i = 0; i < system.nodes(); ++i) {
    const Vector n = W.row(system.first[i]).transpose();
    Q += n * n.transpose();
  }
  system.sum(Q.data(), static_cast<Index>(Q.size()));
  const Eigenpairs found = eigenpairs(Q);
  Index slipping = 0;
  while (slipping < k && found.values[slipping] <= rounding * found.values[k - 1]) ++slipping;
  if (slipping == 0) return 0;
  const DenseMatrix Z = W.lazyProduct(found.vectors.leftCols(slipping)),
                    DZ = system.D.asDiagonal() * Z;
  DenseMatrix sums(slipping, slipping + 1);
  sums << Z.transpose().lazyProduct(DZ), Z.transpose().lazyProduct(F);
  system.sum(sums.data(), static_cast<Index>(sums.size()));
  const Vector work = sums.col(slipping);
  const Real could =
      system.sum(F.lpNorm<1>()) * system.largest(Z.size() > 0 ? Z.cwiseAbs().maxCoeff() : 0);
  constexpr Real exact = 1e-13;  // as it is: rounding of the load
  if (!(work.norm() > exact * could && work.norm() <= told * could)) return 0;
  F -= DZ.lazyProduct(solve(sums.leftCols(slipping), work));
  return work.norm() / could;
}

}  // namespace frictioncg
