#include "multigrid/multigrid_solver.h"

#include <Eigen/Eigenvalues>

#include "clock.h"
#include "condensed/equilibrium.h"
#include "condensed/undetermined.h"
#include "multigrid/inexact_newton.h"

namespace frictioncg {

namespace {

constexpr Real rigid = 1e-11;            ///< <Aw,w>/<Dw,w> of a rigid motion
constexpr Real dependent = 1e-10;        ///< of a mode on the others, in the product of D
constexpr Index most_iterations = 2000;  ///< what takes more is better left to another route
constexpr Index most_unnamed = 80;       ///< the same where method auto chose this one

/// A basis of the modes, orthonormal in the product of D: supports may have left some of them
/// without a dof, or alike.
Eigen::MatrixXd independent(const System& system, const Eigen::MatrixXd& modes) {
  const Eigen::MatrixXd size = modes.transpose() * system.D.asDiagonal() * modes;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of(size);
  const Vector& lambda = of.eigenvalues();
  Eigen::Index lost = 0;
  while (lost < lambda.size() && !(lambda[lost] > dependent * lambda.tail(1)[0])) ++lost;
  const Eigen::Index rank = lambda.size() - lost;
  return modes * of.eigenvectors().rightCols(rank) *
         lambda.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
}

/// Combinations of the modes on which A does no work: none where supports hold the body.
Eigen::MatrixXd free_motions(const System& system, const Eigen::MatrixXd& modes) {
  const Eigen::MatrixXd W = independent(system, modes);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(W.transpose() * (system.A * W));
  Eigen::Index count = 0;
  while (count < W.cols() && ritz.eigenvalues()[count] <= rigid) ++count;
  return W * ritz.eigenvectors().leftCols(count);
}

/// Whether no mesh node has more dofs than the dimension: what is more is no displacement.
bool are_displacements(const System& system) {
  std::vector<int> count;
  for (const Index node : system.mesh_node) {
    if (node >= static_cast<Index>(count.size())) count.resize(node + 1, 0);
    if (++count[node] > system.dimension) return false;
  }
  return !system.mesh_node.empty();
}

std::vector<SemismoothNewton::Branch> branches_of(const std::vector<Face>& faces) {
  std::vector<SemismoothNewton::Branch> branches(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Face& face = faces[i];
    branches[i] = {face.closed, face.stick, face.g, face.w, face.sign, face.d};
  }
  return branches;
}

}  // namespace

MultigridSolver::MultigridSolver(SystemPtr system) : system_(std::move(system)) {
  if (!system_->rigid_modes || !are_displacements(*system_)) return;
  const double start = cpu_seconds();
  const Eigen::MatrixXd modes = system_->rigid_modes();
  if (modes.rows() != system_->dofs() || modes.cols() != (system_->dimension == 2 ? 3 : 6)) return;
  hierarchy_ = make_hierarchy(
      system_->A, make_node_blocks(system_->mesh_node, system_->dimension, system_->interior()),
      modes);
  motions_ = free_motions(*system_, modes);
  setup_ = cpu_seconds() - start;
}

Solution MultigridSolver::solve(const ContactProblem& problem, const Settings& settings,
                                const Vector& x0, Observer* observer) {
  Solution s;
  s.route = Route::multigrid;
  s.layer = problem.nodes() == 0 ? Layer::linear : Layer::multigrid;
  s.levels = {hierarchy_->levels(), hierarchy_->operator_complexity(), hierarchy_->bytes()};
  s.times.factor = setup_;
  setup_ = 0;
  double start = cpu_seconds();
  const Statics statics = motions_.cols() > 0 ? balance(motions_, problem) : Statics();
  if (statics.balance == Balance::unheld) {
    s.status = Status::no_equilibrium;
    s.unheld_motion = statics.motion;
    s.x = Vector::Zero(problem.dofs());
  } else {
    iterate(problem, settings, x0, observer, s);
  }
  s.times.contact = cpu_seconds() - start;
  start = cpu_seconds();
  s.certificate = certify(problem, s.x);
  if (s.status == Status::converged) settle(problem, settings, s);
  s.times.certificate = cpu_seconds() - start;
  return s;
}

void MultigridSolver::iterate(const ContactProblem& problem, const Settings& settings,
                              const Vector& x0, Observer* observer, Solution& s) {
  InexactNewton newton(problem, *hierarchy_, observer);
  const bool named = settings.method == Method::multigrid;
  const Index most = named ? most_iterations : most_unnamed;
  const Index bound = std::min(settings.nbiter > 0 ? settings.nbiter : most, most);
  if (!named) newton.give_up_early();
  s.status = newton.solve(settings.tol, bound, x0, last_);
  s.x = newton.x();
  s.iterations = newton.iterations();
  s.steps = newton.steps();
  if (s.status == Status::converged) last_ = newton.faces();
}

/// Takes out of x the rigid motions that nothing determines, where the laws allow it.
void MultigridSolver::settle(const ContactProblem& problem, const Settings& settings,
                             Solution& s) const {
  if (motions_.cols() == 0) return;
  s.undetermined = left_free(motions_, problem, branches_of(last_));
  if (s.undetermined.cols() == 0) return;
  const Vector x = least(s.x, s.undetermined, system_->D);
  Certificate certificate = certify(problem, x);
  if (certificate.residual > std::max(settings.tol, s.certificate.residual)) return;
  s.x = x;
  s.certificate = std::move(certificate);
}

}  // namespace frictioncg
