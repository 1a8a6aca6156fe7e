#pragma once
#include "condensed/path_matrix.h"
#include "condensed/sparse_factor.h"
#include "multigrid/hierarchy.h"

namespace frictioncg {

/// In place of a hierarchy, A itself, factored by CHOLMOD with each set of faces: the dofs are
/// ordered once, the factor is laid out once, and takes new values. An inverse to rounding, where A
/// is slender enough for its factor to be cheap, or too slender for a hierarchy.
class FactoredMatrix final : public Hierarchy, private SparseFactor {
 public:
  explicit FactoredMatrix(SystemPtr system);

  /// Another matrix of the same pattern, over the same layout.
  void renew(SystemPtr system);
  bool laid_out() const { return L_ != nullptr; }  ///< else too large for CHOLMOD
  double flops() const { return common_.fl; }      ///< of one factorization

  void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) override;
  /// Whether the last truncation left a matrix that is positive definite; apply is 0 where not.
  bool definite() const { return definite_; }
  /// Whether the last truncation was to these dofs, without springs.
  bool is_of(const std::vector<char>& fixed) const { return !springs_ && fixed == fixed_; }
  void apply(const Vector& r, Vector& z) override;
  Index levels() const override { return 1; }
  Real operator_complexity() const override;
  double bytes() const override;

 private:
  SystemPtr system_;
  std::vector<Real> value_;           ///< of A
  std::optional<UpperTriangle> now_;  ///< truncated; the two tangents of a node are coupled
  std::vector<char> fixed_;
  bool definite_ = false, springs_ = false;
};

/// K = D^{-1/2} A D^{-1/2}: the central path on all dofs, where the contact dofs are so many that
/// sparse factors are cheaper than dense ones. What is symmetric of M is factored; the rest, by
/// which pressure sets the limit of friction, is left to conjugate residuals.
class SparsePathMatrix final : public PathMatrix {
 public:
  SparsePathMatrix(const System& system, FactoredMatrix& factor)
      : system_(system), factor_(factor), unit_(system.weight.cwiseSqrt()) {}
  Vector multiply(const Vector& y) const override;
  bool factor(const PathLaws& laws) override;
  Vector solve(const Vector& b) override;

 private:
  const System& system_;
  FactoredMatrix& factor_;
  const Vector unit_;  ///< D^{1/2}
  PathLaws laws_;
};

}  // namespace frictioncg
