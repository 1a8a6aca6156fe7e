#include "parts.h"

#include <algorithm>
#include <cmath>

namespace frictioncg {

namespace {

/// The names of the parts become the least of what each hangs together with: they go back and forth
/// between the processes that share dofs, until none changes. All ask each other for that after 1,
/// 2, 4, ... rounds.
void spread(const Domain& domain, const std::vector<DofOfPart>& dofs, std::vector<Real>& name) {
  Vector least(domain.dofs());
  const auto pack = [&](Index dof, Real* out) { *out = least[dof]; };
  const auto unpack = [&](Index dof, const Real* in) { least[dof] = std::min(least[dof], *in); };
  const auto round = [&] {
    Real changes = 0;
    least.setConstant(INFINITY);
    for (const auto& [dof, part] : dofs) least[dof] = std::min(least[dof], name[part]);
    domain.collect(1, pack, unpack);
    domain.update(least);
    for (const auto& [dof, part] : dofs) {
      if (!(least[dof] < name[part])) continue;
      name[part] = least[dof];
      changes = 1;
    }
    return changes;
  };
  Real changes = 1;
  for (int rounds = 1; changes > 0; rounds *= 2) {
    changes = 0;
    for (int k = 0; k < rounds; ++k) changes = std::max(changes, round());
    changes = domain.largest(changes);
  }
}

}  // namespace

Wholes join_parts(const Domain& domain, const std::vector<DofOfPart>& dofs, Index parts) {
  const Real first = domain.sum_before(parts);
  std::vector<Real> name(parts), own;
  for (Index p = 0; p < parts; ++p) name[p] = first + p;
  spread(domain, dofs, name);
  for (Index p = 0; p < parts; ++p)
    if (name[p] == first + p) own.push_back(name[p]);
  // the names that are left, in ascending order
  const Index before = static_cast<Index>(domain.sum_before(Real(own.size())));
  Real count = Real(own.size());
  domain.sum(&count, 1);
  Vector all = Vector::Zero(static_cast<Index>(count));
  std::copy(own.begin(), own.end(), all.data() + before);
  domain.sum(all.data(), static_cast<Index>(all.size()));
  Wholes wholes{{}, static_cast<Index>(count)};
  for (Real n : name)
    wholes.of_part.push_back(
        static_cast<Index>(std::lower_bound(all.begin(), all.end(), n) - all.begin()));
  return wholes;
}

}  // namespace frictioncg
