#pragma once
#include "multigrid/faces.h"
#include "multigrid/hierarchy.h"

namespace frictioncg {

/// Generalized conjugate residuals, preconditioned from the right by a hierarchy: minimizes the
/// residual over the directions it keeps, whatever the symmetry of the Jacobian.
class ConjugateResiduals {
 public:
  explicit ConjugateResiduals(const System& system);

  /// A new linear system, residual s (n).
  void start(const Vector& s);
  /// One iteration; x and b_C follow. False where no direction reduces the residual.
  bool step(Hierarchy& hierarchy, const Faces& faces, const Vector& springs, Vector& x,
            Vector& b_C);
  Real norm() const { return norm_; }  ///< of the residual, norm_D
  const Vector& residual() const { return s_; }
  bool indefinite() const { return indefinite_; }        ///< A did negative work on a direction
  const Vector& last() const { return kept_[next_].z; }  ///< that direction

 private:
  struct Direction {
    Vector z, Jz, Az_C;
    Real size = 0;  ///< <Jz, Jz>
  };
  Real dot(const Vector& a, const Vector& b) const;
  bool make_orthogonal(Direction& now, const Eigen::Array2d& work_size);

  const System& system_;
  Vector inverse_weight_, s_;
  std::vector<Direction> kept_;
  std::size_t used_ = 0, next_ = 0;
  Real norm_ = 0;
  Real before_ = 0;  ///< <Jz,Jz> of the last direction, before it was made orthogonal
  bool indefinite_ = false;
};

}  // namespace frictioncg
