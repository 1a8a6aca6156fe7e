#pragma once
#include "settings.h"
#include "solution.h"
#include "model/contact_problem.h"

namespace frictioncg {

/// The last word on a status, but where A has negative energy, is the certificate's: converged
/// where its residual is below tol and nowhere else (or where the paper's own rule is asked for);
/// and where rounding is what keeps it above, the method is not blamed.
Status concluded(Status status, const Certificate& certificate, const Settings& settings);

/// The answer to a problem: rest, where nothing loads or penetrates, or else what `solve` makes of
/// it; with its last status and the states of the nodes. floating: the rigid motions that A leaves
/// free (n x k), of which the contact nodes may leave some undetermined at rest, too.
Solution answer(const ContactProblem& problem, const Settings& settings,
                const std::function<Eigen::MatrixXd()>& floating,
                const std::function<Solution()>& solve);

}  // namespace frictioncg
