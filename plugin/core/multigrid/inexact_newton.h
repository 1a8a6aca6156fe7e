#pragma once
#include "multigrid/faces.h"
#include "settings.h"

namespace frictioncg {

/// Generalized conjugate residuals, preconditioned from the right by a hierarchy: minimizes the
/// residual over the directions it keeps, whatever the symmetry of the Jacobian.
class ConjugateResiduals {
 public:
  explicit ConjugateResiduals(const System& system);

  /// A new linear system, residual s (n).
  void start(const Vector& s);
  /// One iteration; x and b_C follow. False where no direction reduces the residual.
  bool step(Hierarchy& hierarchy, const Faces& faces, Vector& x, Vector& b_C);
  Real norm() const { return norm_; }  ///< of the residual, norm_D
  const Vector& residual() const { return s_; }

 private:
  struct Direction {
    Vector z, Jz, Az_C;
    Real size = 0;  ///< <Jz, Jz>
  };
  Real dot(const Vector& a, const Vector& b) const;

  const System& system_;
  Vector inverse_D_, s_;
  std::vector<Direction> kept_;
  std::size_t used_ = 0, next_ = 0;
  Real norm_ = 0;
};

/// Inexact semismooth Newton on the unregularized laws: the linear system of the present faces,
/// solved until its residual falls below a share Gamma of what the faces violate; then all faces
/// are chosen anew.
class InexactNewton {
 public:
  InexactNewton(const ContactProblem& problem, Hierarchy& hierarchy);

  /// From the branches of x0 (n), or where it is empty from the given ones, or where these are,
  /// too, from stick. converged: by the certificate; max_iterations; stagnated: neither a tighter
  /// Gamma nor a new start reduces the violation.
  Status solve(Real tol, Index max_iterations, const Vector& x0,
               const std::vector<Face>& start = {});

  const Vector& x() const { return x_; }
  const std::vector<Face>& faces() const { return faces_.all(); }
  Index iterations() const { return iterations_; }  ///< cycles
  Index updates() const { return updates_; }        ///< of the faces

 private:
  enum class Inner { reached, failed };
  enum class Next { choose, restart, stop };
  void move_onto_faces();
  void recompute_forces();
  Inner solve_faces(Real goal, Index max_iterations);
  Next tighten(Real violation);

  const ContactProblem& problem_;
  const System& system_;
  Hierarchy& hierarchy_;
  Faces faces_;
  ConjugateResiduals inner_;
  Vector x_, b_;  ///< n; b = F - Ax
  Vector b_C_, s_;
  Real Gamma_ = 0.3;
  Real best_ = 0;  ///< violation so far
  int without_progress_ = 0, without_drop_ = 0, restarts_ = 0;
  Real drop_from_ = 0;
  Index iterations_ = 0, updates_ = 0;
};

}  // namespace frictioncg
