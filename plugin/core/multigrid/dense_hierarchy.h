#pragma once
#include "multigrid/coarsest.h"
#include "multigrid/hierarchy.h"

namespace frictioncg {

/// A hierarchy of one level: a small matrix, factored with each set of faces in double precision.
/// Whatever its conditioning, it needs no coarse space.
class DenseHierarchy final : public Hierarchy {
 public:
  explicit DenseHierarchy(const Matrix& A) : A_(A), truncated_(A_) { solver_.factor(A_, shift); }

  void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) override;
  void apply(const Vector& r, Vector& z) override;
  Index levels() const override { return 1; }
  Real operator_complexity() const override { return 1; }
  double bytes() const override;
  Eigen::MatrixXd matrix(Index) const override { return truncated_; }  ///< by dofs

 private:
  /// The diagonal gets this share of itself in addition: far above rounding, far below A.
  static constexpr Real shift = 1e-10;

  Eigen::MatrixXd A_, truncated_;
  std::vector<char> fixed_;
  CoarsestSolver solver_;
};

}  // namespace frictioncg
