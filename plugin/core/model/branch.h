#pragma once
#include "model/law.h"

namespace frictioncg {

/// The branch of the laws that a contact node is on. r is the force of the body on the obstacle:
///   open    r_N = 0, and r_T = 0 (a given limit acts there, too)
///   closed  x_N = gap
///   stick   x_T = 0
///   slip    r_T = g d + w (I - dd') x_T,  g = base + slope r_N
///   touching, a closed node in slip with a part of its cohesion:  r_N = 0, as a slope without end
struct Branch {
  bool closed = true, stick = true;
  bool capped = false;  ///< closed, and the limit does not grow with r_N any more
  bool touching = false;
  Real sign = 1;  ///< of r_N, where contact is bilateral
  Real g = 0;     ///< sliding limit when the branch was chosen [force]
  Real w = 0;     ///< [force/length]
  Eigen::Vector2d d = Eigen::Vector2d::Zero();

  /// Stick or slip at the limit g, by y = r_T + c x_T. Near the limit w grows without bound: up to
  /// `most` times c.
  void choose_friction(const Tangent& y, Real limit, Real c, Real most);

  /// The sliding limit base + slope r_N.
  struct Limit {
    Real base, slope;
  };
  Limit limit(const NodeLaw& law) const {
    if (!closed) return {law.open_limit(), 0};
    if (touching) return {0, steep};
    return capped ? Limit{law.cap, 0} : Limit{law.c, sign * law.mu};
  }
  static constexpr Real steep = 1e10;  ///< stands for the slope at the jump of cohesion
  /// Chooses sign, capped and g at r_N, which an open node has none of; not touching.
  void choose_limit(const NodeLaw& law, Real r_N);
  /// Touching, where closing and r_N are almost 0 and the node slips by less shear than it could.
  void choose_touch(const NodeLaw& law, Real closing, const Eigen::Ref<const Vector>& x,
                    const Eigen::Ref<const Vector>& r, Real c);

  /// w (I - dd'), symmetric positive semi-definite
  Eigen::Matrix2d stiffness() const;
};
using Branches = std::vector<Branch>;  ///< m

/// The branch that a node is on at (x, r), both its normal, then its tangents. closing as in
/// NodeLaw; c, most as above.
Branch branch_at(const NodeLaw& law, Real closing, const Eigen::Ref<const Vector>& x,
                 const Eigen::Ref<const Vector>& r, Real c, Real most = infinity);

/// The stiffness of a body for half a wave along the contact, over that of one node, which meets
/// S_TT, about E: a wave of wave number k meets S = E k h, h the distance of the m nodes. Sliding
/// zones are as wide as the contact, L = m^{1/(d-1)} h, so that k = pi/L: with a c of that size
/// r_T + c x_T weighs force and slip of such a motion alike, and tells the branches that it leads
/// to.
Real wave_share(const System& system);

/// Where every node that can close is closed, and every one of them with friction in stick.
Branches all_stick(const Increment& increment);

/// The same where the last answer was closed, or nothing where there is none: where an increment
/// starts. From the slip of the last one a load that is taken off would push out what friction
/// holds, an answer that no path leads to.
Branches stick_where_closed(const Increment& increment, const Branches& last);

}  // namespace frictioncg
