#include "multigrid/multigrid_solver.h"

#include <Eigen/Eigenvalues>

#include "clock.h"
#include "condensed/equilibrium.h"
#include "multigrid/inexact_newton.h"

namespace frictioncg {

namespace {

constexpr Real rigid = 1e-11;            ///< <Aw,w>/<Dw,w> of a rigid motion
constexpr Index most_iterations = 2000;  ///< of a call that names no bound

/// Combinations of the modes on which A does no work: none where supports hold the body.
Eigen::MatrixXd free_motions(const System& system, const Eigen::MatrixXd& modes) {
  const Eigen::MatrixXd A_modes = system.A * modes;
  const Eigen::MatrixXd energy = modes.transpose() * A_modes;
  const Eigen::MatrixXd size = modes.transpose() * system.D.asDiagonal() * modes;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(energy, size);
  if (ritz.info() != Eigen::Success) return Eigen::MatrixXd(modes.rows(), 0);
  Eigen::Index count = 0;
  while (count < modes.cols() && ritz.eigenvalues()[count] <= rigid) ++count;
  return modes * ritz.eigenvectors().leftCols(count);
}

}  // namespace

MultigridSolver::MultigridSolver(SystemPtr system, const Eigen::MatrixXd& modes)
    : system_(std::move(system)) {
  if (system_->mesh_node.empty() || modes.rows() != system_->dofs())
    throw IllegalInput(
        "method=\"multigrid\" needs the nodes of the mesh and their coordinates, which this "
        "finite-element space does not tell");
  const double start = cpu_seconds();
  hierarchy_ = make_hierarchy(
      system_->A, make_node_blocks(system_->mesh_node, system_->dimension, system_->interior()),
      modes);
  motions_ = free_motions(*system_, modes);
  setup_ = cpu_seconds() - start;
}

Solution MultigridSolver::solve(const ContactProblem& problem, const Settings& settings,
                                const Vector& x0) {
  Solution s;
  s.route = Route::multigrid;
  s.times.factor = setup_;
  setup_ = 0;
  const double start = cpu_seconds();
  const Increment& increment = problem.increment;
  const Index contact = problem.contact_dofs();
  InexactNewton newton(problem, *hierarchy_);
  if (motions_.cols() > 0 &&
      cannot_be_held(problem, motions_.bottomRows(contact), motions_.transpose() * increment.F,
                     increment.F.cwiseAbs().sum())) {
    s.status = Status::no_equilibrium;
    s.x = Vector::Zero(problem.dofs());
  } else {
    const Index bound = settings.nbiter > 0 ? settings.nbiter : most_iterations;
    s.status = newton.solve(settings.tol, bound, x0, last_);
    s.x = newton.x();
    if (s.status == Status::converged) last_ = newton.faces();
  }
  s.iterations = newton.iterations();
  s.passes = newton.updates();
  s.times.contact = cpu_seconds() - start;
  s.certificate = certify(problem, s.x);
  s.times.certificate = cpu_seconds() - start - s.times.contact;
  s.state = classify(problem, s.x, s.certificate.r);
  return s;
}

}  // namespace frictioncg
