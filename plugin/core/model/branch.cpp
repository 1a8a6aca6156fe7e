#include "model/branch.h"

namespace frictioncg {

void Branch::choose_friction(const Tangent& y, Real limit, Real c, Real most) {
  const Real norm = y.norm();
  g = limit;
  w = 0;
  stick = g > 0 && norm <= g;
  if (stick) return;
  d.setZero();
  if (norm > 0) d.head(y.size()) = y / norm;
  if (g > 0 && y.size() == 2) w = g * c / std::max(norm - g, g / most);
}

Branch branch_at(const NodeLaw& law, Real closing, const Eigen::Ref<const Vector>& x,
                 const Eigen::Ref<const Vector>& r, Real c, Real most) {
  const Index t = static_cast<Index>(x.size()) - 1;
  Branch b;
  b.closed = law.closed(closing, r[0]);
  b.sign = law.bilateral && r[0] < 0 ? -1 : 1;
  b.g = law.limit(b.closed ? r[0] : 0);
  if (t > 0) b.choose_friction(r.tail(t) + c * x.tail(t), b.g, c, most);
  return b;
}

Branches all_stick(const Increment& increment) {
  Branches branches(increment.gap.size());
  for (std::size_t i = 0; i < branches.size(); ++i) {
    const Index node = static_cast<Index>(i);
    branches[i].closed = std::isfinite(increment.gap[node]);
    branches[i].stick = branches[i].closed && law_of(increment, node).has_friction();
  }
  return branches;
}

}  // namespace frictioncg
