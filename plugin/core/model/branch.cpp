#include "model/branch.h"

namespace frictioncg {

namespace {
/// Of the cohesion: what counts as no pressure and no gap. Proximal points come as near to a node
/// that touches; at 1e-6 Newton's method does not take it over from them, at 1e-2 hardly more
/// often.
constexpr Real almost = 1e-4;
constexpr Real half_wave = 3;  ///< about pi
}  // namespace

Eigen::Matrix2d Branch::stiffness() const {
  return w * (Eigen::Matrix2d::Identity() - d * d.transpose());
}

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

void Branch::choose_limit(const NodeLaw& law, Real r_N) {
  sign = law.bilateral && r_N < 0 ? -1 : 1;
  capped = closed && law.capped(r_N);
  touching = false;
  g = closed ? law.limit(r_N) : law.open_limit();
}

void Branch::choose_touch(const NodeLaw& law, Real closing, const Eigen::Ref<const Vector>& x,
                          const Eigen::Ref<const Vector>& r, Real c) {
  const Index t = static_cast<Index>(x.size()) - 1;
  if (t == 0 || !law.coheres()) return;
  const Real most = law.limit(0), little = almost * most, shear = r.tail(t).norm();
  if (std::max(std::abs(closing), std::abs(r[0])) > little) return;
  if (shear < little || shear > most || r.tail(t).dot(x.tail(t)) < 0) return;
  if (c * x.tail(t).norm() < little) return;
  touching = closed = true;
  capped = false;
  choose_friction(r.tail(t) + c * x.tail(t), shear, c, infinity);
}

Branch branch_at(const NodeLaw& law, Real closing, const Eigen::Ref<const Vector>& x,
                 const Eigen::Ref<const Vector>& r, Real c, Real most) {
  const Index t = static_cast<Index>(x.size()) - 1;
  Branch b;
  b.closed = law.closed(closing, r[0]);
  b.choose_limit(law, r[0]);
  if (t > 0) b.choose_friction(r.tail(t) + c * x.tail(t), b.g, c, most);
  return b;
}

Real wave_share(const System& system) {
  const Real m = system.sum(Real(system.nodes()));
  return std::min(1.0, half_wave / (system.dimension == 2 ? m : std::sqrt(m)));
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

Branches stick_where_closed(const Increment& increment, const Branches& last) {
  if (last.empty()) return {};
  Branches branches = all_stick(increment);
  for (std::size_t i = 0; i < branches.size(); ++i)
    if (!last[i].closed) branches[i] = last[i];
  return branches;
}

}  // namespace frictioncg
