#include "equilibrium.h"

#include <algorithm>
#include <cmath>

namespace frictioncg {

namespace {

constexpr Index most_rigid_motions = 6;
constexpr Real shift = 1e-9;       ///< of inverse iteration, relative to D
constexpr Real rigid = 1e-11;      ///< <Sw,w>/<Dw,w> of a rigid motion
constexpr Real admissible = 1e-9;  ///< of w_N + mu |w_T|, relative to |w|

/// Motions of the contact dofs that cost no energy, D-orthonormal, by inverse iteration on S +
/// shift D.
DenseMatrix rigid_motions(const DenseMatrix& S) {
  const Index n = static_cast<Index>(S.rows()), most = std::min(n, most_rigid_motions);
  const Vector D = S.diagonal().cwiseMax(1e-300);
  const Vector scale = D.cwiseSqrt().cwiseInverse();
  DenseMatrix M = scale.asDiagonal() * S * scale.asDiagonal();
  M.diagonal().array() += shift;
  const Eigen::LLT<DenseMatrix> factor(M);
  if (factor.info() != Eigen::Success) return DenseMatrix(n, 0);
  DenseMatrix W(n, most);
  for (Index j = 0; j < most; ++j)  // any start that is not special
    for (Index i = 0; i < n; ++i) W(i, j) = std::cos(1.0 + i * (j + 1.37) + 0.7 * j);
  for (int k = 0; k < 4; ++k) {
    W = factor.solve(W);
    W = Eigen::HouseholderQR<DenseMatrix>(W).householderQ() * DenseMatrix::Identity(n, most);
  }
  M.diagonal().array() -= shift;
  const Eigen::SelfAdjointEigenSolver<DenseMatrix> ritz(W.transpose() * M * W);
  Index count = 0;
  while (count < most && ritz.eigenvalues()[count] <= rigid) ++count;
  return scale.asDiagonal() * (W * ritz.eigenvectors().leftCols(count));
}

/// The conditions on w = W a as hinges max(0, c): c_0 = 1 - (f.w - sum g |w_T|), c_i = w_N + mu
/// |w_T|.
struct Conditions {
  const ContactProblem& laws;
  const CondensedProblem& condensed;
  const DenseMatrix& W;
  Vector load;  ///< W' f, scaled

  void evaluate(const Vector& a, Vector& hinge, DenseMatrix& J) const {
    const Vector w = W * a;
    hinge.setZero(laws.nodes() + 1);
    J.setZero(laws.nodes() + 1, a.size());
    Real c_0 = 1 - load.dot(a);
    Vector slope_0 = -load;
    for (Index i = 0; i < laws.nodes(); ++i) {
      const Index N = condensed.normal(i), t = laws.tangents(i);
      const Real slide = w.segment(N + 1, t).norm();
      Vector along = Vector::Zero(a.size());
      if (slide > 0) along = W.middleRows(N + 1, t).transpose() * w.segment(N + 1, t) / slide;
      const Real mu = laws.law == Law::coulomb ? laws.mu[i] : 0;
      if (laws.law == Law::tresca && t > 0) {
        c_0 += laws.g[i] * slide / unit;
        slope_0 += laws.g[i] / unit * along;
      }
      const Real c = w[N] + mu * slide;
      if (c <= 0 || !std::isfinite(laws.gap[i])) continue;
      hinge[i + 1] = c;
      J.row(i + 1) = W.row(N) + mu * along.transpose();
    }
    if (c_0 > 0) {
      hinge[0] = c_0;
      J.row(0) = slope_0.transpose();
    }
  }
  Real unit;  ///< of W' f
};

}  // namespace

bool cannot_be_held(const CondensedProblem& condensed) {
  DenseMatrix W = rigid_motions(condensed.S);
  if (W.cols() == 0) return false;
  W /= W.cwiseAbs().maxCoeff();
  const Vector works = W.transpose() * condensed.f;
  const Real unit = works.norm();
  const Real force = condensed.f.cwiseAbs().sum();
  if (unit <= 1e-12 * force) return false;
  const Conditions conditions{condensed.laws, condensed, W, works / unit, unit};

  // least squares of the hinges, by Levenberg and Marquardt: convex, at most six unknowns
  Vector a = works / unit, hinge, trial_hinge;
  DenseMatrix J, trial_J;
  conditions.evaluate(a, hinge, J);
  Real damping = 1e-3;
  for (int k = 0; k < 500 && hinge.squaredNorm() > 0; ++k) {
    DenseMatrix H = J.transpose() * J;
    H.diagonal().array() += damping * (1e-12 + H.diagonal().maxCoeff());
    const Vector trial = a - H.ldlt().solve(J.transpose() * hinge);
    conditions.evaluate(trial, trial_hinge, trial_J);
    if (trial_hinge.squaredNorm() < hinge.squaredNorm()) {
      a = trial;
      hinge = trial_hinge;
      J = trial_J;
      damping = std::max(damping / 4, 1e-12);
    } else {
      damping *= 4;
      if (damping > 1e12) break;
    }
  }
  const Real size = (W * a).cwiseAbs().maxCoeff();
  return hinge[0] <= 0.5 && hinge.tail(hinge.size() - 1).maxCoeff() <= admissible * size;
}

}  // namespace frictioncg
