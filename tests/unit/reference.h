#pragma once
// An independent solver for small scenes: block Gauss-Seidel over the contact nodes on the dense
// Schur complement, each node's laws solved exactly by cases. It shares no code with the plugin's.
#include <Eigen/Core>

#include "core/model/contact_problem.h"

namespace frictioncg::test {

struct Reference {
  Eigen::VectorXd x;
  bool converged = false;
};

/// One node: finds x with x_N <= gap, r = f - Sx >= 0 complementary, |r_T| <= g along x_T.
Eigen::VectorXd solve_node(const Eigen::MatrixXd& S, const Eigen::VectorXd& f, double gap,
                           double mu, double given, bool coulomb);

Reference reference_solution(const ContactProblem& p);

/// Whether any of the 4^m combinations of open, stick and slip to either side obeys Coulomb's laws
/// on S: 2D, few nodes. Solves each as a linear system.
bool any_combination_of_branches(const Eigen::MatrixXd& S, const Eigen::VectorXd& f,
                                 const Eigen::VectorXd& gap, const Eigen::VectorXd& mu);

}  // namespace frictioncg::test
