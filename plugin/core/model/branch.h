#pragma once
#include "types.h"

namespace frictioncg {

/// The branch of the laws that a contact node is on. r is the force of the body on the obstacle:
///   open    r_N = 0, and r_T = 0 (a given limit acts there, too)
///   closed  x_N = gap
///   stick   x_T = 0
///   slip    r_T = g d + w (I - dd') x_T,  g = sign mu r_N or given
struct Branch {
  bool closed = true, stick = true;
  Real sign = 1;  ///< of r_N, where contact is bilateral
  Real g = 0;     ///< sliding limit when the branch was chosen [force]
  Real w = 0;     ///< [force/length]
  Eigen::Vector2d d = Eigen::Vector2d::Zero();
};
using Branches = std::vector<Branch>;  ///< m

}  // namespace frictioncg
