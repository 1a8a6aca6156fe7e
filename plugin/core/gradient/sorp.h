#pragma once
#include "gradient/tresca.h"

namespace frictioncg {

/// Successive over-relaxation with projection, the peer of the paper's tables: each dof in turn to
/// the minimizer of J along it, over-relaxed by omega, normals projected on x_N <= gap, tangents
/// thresholded at g. Not regularized.
class Sorp final : public TrescaSolver {
 public:
  Sorp(const ContactProblem& problem, const Settings& settings, Index max_iterations,
       Observer* observer);
  Outcome minimize(Iterate& it, const Vector& g, Real eps, Tangents tangents,
                   Real tolerance) override;
  bool regularized() const override { return false; }

 private:
  void sweep(Vector& x, const Vector& g, Tangents tangents);
  void update(Vector& x, Index i, Real value);
  void relax_tangents(Vector& x, Index node, Real g);
  Real row_residual(const Vector& x, Index i) const;
  Real violation(const Vector& x, const Vector& g, Tangents tangents);

  const ContactProblem& problem_;
  const Settings& settings_;
  const Index max_iterations_;
  Observer* const observer_;
  const Vector& D_;
  const Real omega_;
  Vector stiffness_;  ///< m, largest eigenvalue of A_TT at the node
  Vector r_;
  Real change_ = 0;  ///< of the last sweep: sum a_ii dx_i^2
  Index iterations_ = 0;
};

}  // namespace frictioncg
