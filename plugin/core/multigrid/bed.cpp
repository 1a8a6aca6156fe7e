#include "multigrid/bed.h"

#include "linear_algebra.h"

namespace frictioncg {

namespace {

/// A start need not be exact: the bed is left as it is after so many steps.
constexpr int most_steps = 50;
/// What fewer springs leave free does not move ...
constexpr Real singular = 1e-10;
/// ... and where that leaves this share of the load, they do not hold it: a single node no moment.
constexpr Real unheld = 1e-6;
/// An idle obstacle stays at all of its nodes, up to this share of their gaps.
constexpr Real rounding = 1e-9;

}  // namespace

Branches reached(const ContactProblem& problem) {
  const System& system = *problem.system;
  const Increment& increment = problem.increment;
  const Branches stick = all_stick(increment);
  if (system.border.cols() == 0 || increment.bilateral) return stick;
  const Vector load = system.border.transpose() * increment.F;
  const DenseMatrix C = DenseMatrix(system.border).bottomRows(system.contact_dofs());
  const Real share = wave_share(system);
  Branches faces = stick;
  bool changes = true, any = true;
  for (int step = 0; changes && any && step < most_steps; ++step) {
    DenseMatrix H = DenseMatrix::Zero(C.cols(), C.cols());
    Vector f = load;
    for (Index i = 0; i < problem.nodes(); ++i) {
      if (!faces[i].closed) continue;
      const Index N = system.first[i] - system.interior();
      const auto C_i = C.middleRows(N, faces[i].stick ? 1 + system.tangents(i) : 1);
      const Real k = share * system.weight[system.first[i]];
      H += k * C_i.transpose().lazyProduct(C_i);
      f += k * increment.gap[i] * C.row(N).transpose();
    }
    const Vector q = least_squares(H, f, singular);
    if ((H.lazyProduct(q) - f).norm() > unheld * load.norm()) return stick;
    changes = any = false;
    for (Index i = 0; i < problem.nodes(); ++i) {
      const auto row = C.row(system.first[i] - system.interior());
      if (!stick[i].closed || row.isZero(0)) continue;
      const Real gap = increment.gap[i];
      const bool closed = row.dot(q) >= gap - rounding * std::abs(gap);
      changes = changes || closed != faces[i].closed;
      any = any || closed;
      faces[i].closed = closed;
      faces[i].stick = closed && stick[i].stick;
    }
  }
  return any ? faces : stick;
}

}  // namespace frictioncg
