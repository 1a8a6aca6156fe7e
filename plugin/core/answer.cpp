#include "answer.h"

#include "statics/undetermined.h"
#include "model/certificate.h"
#include "threads.h"

namespace frictioncg {

namespace {

/// Neither a load nor a penetration, on any process: the body stays where it is, whatever else
/// could move it.
bool at_rest(const ContactProblem& problem) {
  const Increment& increment = problem.increment;
  const auto closed = increment.gap.array();
  const bool here =
      increment.F.isZero(0) && (increment.bilateral ? (closed == 0).all() : (closed >= 0).all());
  return problem.system->largest(here ? 0 : 1) == 0;
}

}  // namespace

Status concluded(Status status, const Certificate& certificate, const Settings& settings) {
  if (status == Status::not_positive_definite) return status;
  if (certificate.residual <= settings.tol) return Status::converged;
  if (status == Status::converged) return settings.stop_on_step > 0 ? status : Status::stagnated;
  const bool blames_method = status == Status::max_iterations || status == Status::regularized ||
                             status == Status::fixed_point_diverged;
  return blames_method && may_be_rounding(certificate) ? Status::stagnated : status;
}

Solution answer(const ContactProblem& problem, const Settings& settings,
                const std::function<Eigen::MatrixXd()>& floating,
                const std::function<Solution()>& solve) {
  const Threads threads(settings.threads);
  Solution s;
  if (at_rest(problem)) {
    s.x = Vector::Zero(problem.dofs());
    s.certificate = certify(problem, s.x);
    s.undetermined = left_free(floating(), problem, branches_of(problem, s.x, s.certificate));
  } else {
    s = solve();
  }
  if (s.status == Status::not_positive_definite &&
      !costs_negative_energy(*problem.system, s.negative))
    s.status = Status::stagnated;
  s.status = concluded(s.status, s.certificate, settings);
  if (s.status == Status::not_positive_definite)  // no field that motions could be taken out of
    s.undetermined = DenseMatrix(problem.dofs(), 0);
  s.state = classify(problem, s.x, s.certificate);
  return s;
}

}  // namespace frictioncg
