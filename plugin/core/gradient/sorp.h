#pragma once
#include "gradient/tresca.h"
#include "model/contact_problem.h"

namespace frictioncg {

/// Successive over-relaxation with projection, the peer of the paper's tables: each dof in turn to
/// the minimizer of J along it, over-relaxed by omega, normals projected on x_N <= gap, tangents
/// thresholded at g. Not regularized.
class Sorp final : public TrescaSolver {
 public:
  /// max_iterations bounds the sweeps of all minimizations together. The observer may be null.
  Sorp(const ContactProblem& problem, const Settings& settings, Index max_iterations,
       Observer* observer);
  Outcome minimize(Vector& x, const Vector& g, Real eps, Tangents tangents, Real bound) override;
  bool regularized() const override { return false; }

 private:
  struct Change {
    Real energy = 0;  ///< sum of a_ii dx_i^2
    Real square = 0;  ///< sum of dx_i^2
  };

  void start(Vector& x, Tangents tangents) const;
  Change sweep(Vector& x, const Vector& g, Tangents tangents) const;
  void update(Vector& x, Index i, Real value, Change& change) const;
  void relax_tangents(Vector& x, Index node, Real g, Change& change) const;
  Real row_residual(const Vector& x, Index i) const;
  Real violation(const Vector& x, const Vector& g, Tangents tangents);
  bool settled(const Vector& x, const Vector& g, Tangents tangents, Real bound,
               const Change& change);

  const ContactProblem& problem_;
  const Settings& settings_;
  const Index max_iterations_;
  Observer* const observer_;
  const Vector& D_;
  const Real omega_;
  const Vector stiffness_;  ///< m, of A_TT
  Vector residual_;         ///< n, of the last measurement
  Real ratio_ = 0;          ///< last measured violation over the change of its sweep
  Index since_measured_ = 0;
  Index iterations_ = 0;  ///< over all minimizations
};

}  // namespace frictioncg
