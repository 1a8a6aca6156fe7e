#pragma once
#include "types.h"

namespace frictioncg {

/// The point of a cone, given by columns that come one by one, that is nearest to a target
/// (nonnegative least squares of Lawson and Hanson).
class NearestInCone {
 public:
  explicit NearestInCone(const Vector& target);

  const Vector& rest() const { return rest_; }  ///< target - nearest point

  /// Takes the columns into the cone that bring it nearer to the target. False where none does: a
  /// column that rounding keeps out is passed over for the next.
  bool add(const DenseMatrix& columns);

 private:
  Index count() const { return static_cast<Index>(weight_.size()); }
  auto G() const { return G_.leftCols(count()); }
  auto Q() const { return Q_.leftCols(count()); }

  bool add_one(const Vector& column);
  bool append(Vector unit, Real weight);
  void remove(Index j);
  bool step();
  Vector orthogonal_rest() const;

  const Vector target_;
  Vector rest_;
  DenseMatrix G_, Q_, R_;     ///< the unit columns of positive weight, G = QR
  std::vector<Real> weight_;  ///< of the unit columns
};

}  // namespace frictioncg
