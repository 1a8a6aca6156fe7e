#pragma once
#include "types.h"

namespace frictioncg {

/// Proximal points: springs of stiffness eps D on the contact dofs, whose other ends follow,
///   (A + eps D) x_k = F + eps D x_{k-1} - r.
/// For eps > 0 the matrix is definite, whatever motions contact leaves free: the body creeps to
/// where contact and friction hold it. eps falls where a point is found, and rises where not.
class ProximalSprings {
 public:
  ProximalSprings(Real first, Real least) : eps_(first), least_(least) {}

  Real eps() const { return eps_; }
  bool softest() const { return eps_ <= least_; }

  void found() {
    eps_ = std::max((missed_ ? warily_softer : softer) * eps_, std::min(eps_, least_));
  }
  void missed() {
    eps_ *= stiffer;
    missed_ = true;
  }

 private:
  /// eps falls to this share from point to point, and by less once a point was not found: else 6 of
  /// 1937 random scenes lose their answer with multigrid. Half and twice change cycles by 2 %.
  static constexpr Real softer = 0.1, warily_softer = 0.3;
  /// eps rises to so many times itself where a point was not found. Half and twice take 2 % more.
  static constexpr Real stiffer = 10;
  Real eps_;
  const Real least_;
  bool missed_ = false;
};

}  // namespace frictioncg
