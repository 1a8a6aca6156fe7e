#include "multigrid/past.h"

namespace frictioncg {

namespace {

/// A load goes on by at most so many times the last step: what lies further is another path.
constexpr Real furthest = 4;

/// <f, g> of the loads and gaps of two differences. Gaps that no obstacle closes are left out.
Real product(const System& s, const Vector& F, const Vector& gap_f, const Vector& G,
             const Vector& gap_g) {
  Real sum = (F.array() * G.array() / s.weight.array()).sum();
  for (Index i = 0; i < s.nodes(); ++i) {
    const Real both = s.weight[s.first[i]] * gap_f[i] * gap_g[i];
    if (std::isfinite(both)) sum += both;
  }
  return s.sum(sum);
}

}  // namespace

void Past::add(const Increment& increment, const Vector& x) {
  before_ = std::move(last_);
  last_ = {increment.F, increment.gap, x};
  answers_ = std::min(answers_ + 1, 2);
}

Vector Past::next(const System& system, const Increment& increment) const {
  if (answers_ == 0) return {};
  if (answers_ == 1) return last_.x;
  const Vector F = last_.F - before_.F, gap = last_.gap - before_.gap;
  const Real size2 = product(system, F, gap, F, gap);
  const Real along = product(system, increment.F - last_.F, increment.gap - last_.gap, F, gap);
  if (!(size2 > 0)) return last_.x;
  return last_.x + std::clamp(along / size2, -furthest, furthest) * (last_.x - before_.x);
}

}  // namespace frictioncg
