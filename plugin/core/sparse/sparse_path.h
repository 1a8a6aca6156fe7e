#pragma once
#include "condensed/path_matrix.h"
#include "sparse/factored_matrix.h"

namespace frictioncg {

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
