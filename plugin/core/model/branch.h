#pragma once
#include <limits>

#include "model/law.h"

namespace frictioncg {

/// The branch of the laws that a contact node is on. r is the force of the body on the obstacle:
///   open    r_N = 0, and r_T = 0 (a given limit acts there, too)
///   closed  x_N = gap
///   stick   x_T = 0
///   slip    r_T = g d + w (I - dd') x_T,  g = given limit + slope r_N
struct Branch {
  bool closed = true, stick = true;
  Real sign = 1;  ///< of r_N, where contact is bilateral
  Real g = 0;     ///< sliding limit when the branch was chosen [force]
  Real w = 0;     ///< [force/length]
  Eigen::Vector2d d = Eigen::Vector2d::Zero();

  /// Stick or slip at the limit g, by y = r_T + c x_T. Near the limit w grows without bound: up to
  /// `most` times c.
  void choose_friction(const Tangent& y, Real limit, Real c, Real most);

  /// Of the sliding limit over r_N.
  Real slope(const NodeLaw& law) const { return closed ? sign * law.mu : 0; }

  /// w (I - dd'), symmetric positive semi-definite
  Eigen::Matrix2d stiffness() const {
    return w * (Eigen::Matrix2d::Identity() - d * d.transpose());
  }
};
using Branches = std::vector<Branch>;  ///< m

/// The branch that a node is on at (x, r), both its normal, then its tangents. closing as in
/// NodeLaw; c, most as above.
Branch branch_at(const NodeLaw& law, Real closing, const Eigen::Ref<const Vector>& x,
                 const Eigen::Ref<const Vector>& r, Real c,
                 Real most = std::numeric_limits<Real>::infinity());

/// Where every node that can close is closed, and every one of them with friction in stick.
Branches all_stick(const Increment& increment);

}  // namespace frictioncg
