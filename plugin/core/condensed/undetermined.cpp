#include "condensed/undetermined.h"

#include <cmath>

namespace frictioncg {

namespace {
constexpr Real forbidden = 1e-9;  ///< part of a unit motion that the laws stand against
}

DenseMatrix left_free(const DenseMatrix& W, const ContactProblem& problem,
                      const std::vector<SemismoothNewton::Branch>& branches) {
  const DenseMatrix W_C = W.bottomRows(problem.contact_dofs());
  DenseMatrix barred = DenseMatrix::Zero(W_C.rows(), W_C.cols());
  for (Index i = 0; i < problem.nodes(); ++i) {
    const SemismoothNewton::Branch& b = branches[i];
    const Index N = problem.system->first[i] - problem.interior(), t = problem.tangents(i);
    const Real unit = std::sqrt(problem.system->D[problem.system->first[i]]);
    const auto slide = W_C.middleRows(N + 1, t);
    if (b.closed) barred.row(N) = unit * W_C.row(N);
    if (b.stick) barred.middleRows(N + 1, t) = unit * slide;
    if (!b.stick && b.g > 0 && t == 2)
      barred.row(N + 1) = unit * (b.d[1] * slide.row(0) - b.d[0] * slide.row(1));
  }
  const Eigen::JacobiSVD<DenseMatrix> svd(barred, Eigen::ComputeFullV);
  Index held = 0;
  while (held < svd.singularValues().size() && svd.singularValues()[held] > forbidden) ++held;
  return W * svd.matrixV().rightCols(W.cols() - held);
}

Vector least(const Vector& x, const DenseMatrix& motions, const Vector& D) {
  const DenseMatrix weighted = D.asDiagonal() * motions;
  return x - motions * (motions.transpose() * weighted).ldlt().solve(weighted.transpose() * x);
}

}  // namespace frictioncg
