#pragma once
#include "gradient/iterate.h"
#include "gradient/preconditioner.h"
#include "gradient/regularization.h"

namespace frictioncg {

/// The friction of (11): what g phi'(x_T) takes from the residual, and what g phi'' adds to J''
/// (17), on the free contact dofs.
class FrictionTerm {
 public:
  explicit FrictionTerm(const ContactProblem& problem);

  /// After x, r_C = F - Ax or the faces have changed. True where a node has come to another piece
  /// of a piecewise quadratic J: across eps, or, with eps = 0, across x_T = 0 along a single
  /// tangent.
  bool update(const Vector& x, const Vector& r_C, const ActiveSet& faces, const Vector& g,
              const Phi& phi);

  const Vector& r() const { return r_; }  ///< -J', contact_dofs(): r_C less friction, 0 where held
  const ContactPart& part() const { return part_; }

  /// <g phi'(x_T), v>: what <F - Ax, v> has more than <-J', v>; v is 0 on held dofs.
  Real along(const Vector& r_C, const Vector& v) const;

 private:
  const System& system_;
  Vector r_;
  ContactPart part_;
  std::vector<char> piece_;  ///< m, which one x_T was on
};

}  // namespace frictioncg
