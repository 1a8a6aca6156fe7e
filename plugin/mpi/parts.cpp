#include "parts.h"

namespace frictioncg {

namespace {

/// The names of the parts become the least of what each hangs together with: they go back and forth
/// between the processes that share dofs, until none changes. All ask each other for that after 1,
/// 2, 4, ... rounds.
void spread(const Domain& domain, const std::vector<Index>& dofs, const std::vector<Index>& part,
            std::vector<Real>& name) {
  Vector least(domain.dofs());
  const auto round = [&] {
    Real changes = 0;
    least.setConstant(INFINITY);
    for (std::size_t k = 0; k < dofs.size(); ++k)
      least[dofs[k]] = std::min(least[dofs[k]], name[part[k]]);
    domain.least(least);
    for (std::size_t k = 0; k < dofs.size(); ++k) {
      if (!(least[dofs[k]] < name[part[k]])) continue;
      name[part[k]] = least[dofs[k]];
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

Bodies join_parts(const Domain& domain, const std::vector<Index>& dofs, const Bodies& parts) {
  const Real first = domain.sum_before(parts.count);
  std::vector<Real> name(parts.count), own;
  for (Index p = 0; p < parts.count; ++p) name[p] = first + p;
  spread(domain, dofs, parts.of, name);
  for (Index p = 0; p < parts.count; ++p)
    if (name[p] == first + p) own.push_back(name[p]);
  // the names that are left, in ascending order
  const Index before = static_cast<Index>(domain.sum_before(Real(own.size())));
  Real count = Real(own.size());
  domain.sum(&count, 1);
  Vector all = Vector::Zero(static_cast<Index>(count));
  std::copy(own.begin(), own.end(), all.data() + before);
  domain.sum(all.data(), static_cast<Index>(all.size()));
  Bodies wholes{{}, static_cast<Index>(count)};
  for (Index p : parts.of)
    wholes.of.push_back(
        static_cast<Index>(std::lower_bound(all.begin(), all.end(), name[p]) - all.begin()));
  return wholes;
}

}  // namespace frictioncg
