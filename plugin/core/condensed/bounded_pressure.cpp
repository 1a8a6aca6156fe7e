#include "condensed/bounded_pressure.h"

#include "factorization.h"
#include "model/law.h"
#include "statics/undetermined.h"

namespace frictioncg {

namespace {

/// The |N0| of each node gets this share of their mean in addition, so that its bound is above 0.
constexpr Real least_share = 1e-6;
/// The bounds are raised by this share of them, for what rounding leaves of H.
constexpr Real margin = 1e-6;

/// The dofs of contact: normal ones, and tangential ones node by node.
struct Layout {
  explicit Layout(const CondensedProblem& problem) {
    for (Index i = 0; i < problem.laws.nodes(); ++i) {
      N.push_back(problem.normal(i));
      for (Index k = 1; k <= problem.laws.tangents(i); ++k) T.push_back(problem.normal(i) + k);
    }
  }
  std::vector<Index> N, T;
};

/// S_TT, with a stiffness added against the motions along the obstacle, which are its kernel.
DenseMatrix held_along(const CondensedProblem& problem, const DenseMatrix& W, const Layout& dofs) {
  Branches glued(problem.laws.nodes());
  for (Branch& b : glued) b.stick = false;
  const DenseMatrix Z = left_free(W, problem.laws, glued).bottomRows(problem.D.size());
  const Vector root = problem.D(dofs.T).cwiseSqrt();
  DenseMatrix M = problem.S(dofs.T, dofs.T);
  if (Z.cols() == 0) return M;
  const DenseMatrix scaled = root.asDiagonal() * Z(dofs.T, Eigen::all);
  const DenseMatrix along = root.asDiagonal() * scaled.colwise().normalized();
  M.noalias() += along * along.transpose();
  return M;
}

/// Bounds p (m) on the pressure of each node; empty where there are none.
Vector bounds(const CondensedProblem& problem, const DenseMatrix& W) {
  const Layout dofs(problem);
  const Increment& increment = problem.laws.increment;
  const Index m = problem.laws.nodes();
  DenseMatrix S_TT = held_along(problem, W, dofs);
  const Cholesky factor(S_TT);
  if (dofs.T.empty() || !factor.found()) return {};
  const DenseMatrix S_TN = problem.S(dofs.T, dofs.N);
  const DenseMatrix H = factor.solve(S_TN);  // transposed
  const Vector b = problem.f(dofs.T) - S_TN * increment.gap;
  const DenseMatrix S_NN = problem.S(dofs.N, dofs.N);
  Vector N0 = problem.f(dofs.N) - S_NN * increment.gap - H.transpose() * b;
  N0 = N0.cwiseAbs();
  N0.array() += least_share * N0.mean();
  DenseMatrix M = DenseMatrix::Identity(m, m);
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j) {
      const Index first = problem.normal(j) - j;  // in T
      const Real unit = H.col(i).segment(first, problem.laws.tangents(j)).norm();
      M(i, j) -= increment.mu[j] * unit;
      if (increment.cohesion.size() > 0) N0[i] += increment.cohesion[j] * unit;
    }
  const Vector p = LU(M).solve(N0);
  if (!p.allFinite() || !(p.array() > 0).all()) return {};
  return (1 + margin) * p;  // M p > 0 with p > 0: the sum of what follows from N0 is finite
}

}  // namespace

std::optional<Vector> unheld_at_bounded_pressure(const DenseMatrix& W,
                                                 const CondensedProblem& problem) {
  const Increment& increment = problem.laws.increment;
  if (!increment.bilateral || increment.law != Law::coulomb || W.cols() == 0) return std::nullopt;
  const Vector p = bounds(problem, W);
  if (p.size() == 0) return std::nullopt;
  ContactProblem limited = problem.laws;
  limited.increment.law = Law::tresca;
  limited.increment.g.resize(p.size());
  for (Index i = 0; i < p.size(); ++i) limited.increment.g[i] = law_of(increment, i).limit(p[i]);
  return unheld_motion(W, limited);
}

}  // namespace frictioncg
