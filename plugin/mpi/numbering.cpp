#include "numbering.h"

namespace frictioncg {

Numbering::Numbering(const Domain& domain, const LocalSystem& local,
                     const std::vector<Index>& mesh_node)
    : dimension(local.system()->dimension), slot(local.basis().local_dofs()) {
  const Basis& basis = local.basis();
  // of each mesh node in ascending order: the same on every process that has it
  std::map<Index, std::vector<Index>> by_node;
  for (Index p = 0; p < basis.local_dofs(); ++p) by_node[mesh_node[basis.origin[p]]].push_back(p);
  const auto owned = [&](const std::vector<Index>& dofs) {
    return domain.owns(basis.origin[dofs.front()]);
  };
  std::map<Index, Index> start_of;  // own nodes, from `first` on
  for (const auto& [node, dofs] : by_node)
    if (owned(dofs)) {
      start_of[node] = static_cast<Index>(at.size()) * dimension;
      at.push_back(dofs);
    }
  first = static_cast<PetscInt>(domain.sum_before(slots()));

  Vector start = Vector::Constant(domain.dofs(), -1);  // of the node, at each dof of the script
  for (Index i = 0; i < domain.dofs(); ++i) {
    const auto found = start_of.find(mesh_node[i]);
    if (found != start_of.end()) start[i] = Real(first + found->second);
  }
  domain.update(start);
  for (const auto& [node, dofs] : by_node)
    for (std::size_t k = 0; k < dofs.size(); ++k)
      slot[dofs[k]] = static_cast<PetscInt>(start[basis.origin[dofs[k]]]) + PetscInt(k);
  const System& system = *local.system();
  for (Index p = 0; p < system.interior(); ++p)
    if (is_own(p)) own.push_back(p);
  for (Index i = 0; i < system.nodes(); ++i) {
    if (!is_own(system.first[i])) continue;
    own_nodes.push_back(i);
    own_first.push_back(static_cast<Index>(own.size()));
    for (Index p = system.first[i]; p < system.first[i + 1]; ++p) own.push_back(p);
  }
  own_first.push_back(static_cast<Index>(own.size()));
  for (Index p : own) own_slot.push_back(slot[p] - first);
}

NodeNumbers::NodeNumbers(const Domain& domain, Index dimension, const std::vector<Index>& mesh_node)
    : dimension_(dimension), of_(domain.dofs()) {
  const auto starts = [&](Index i) { return i == 0 || mesh_node[i] != mesh_node[i - 1]; };
  Vector number = Vector::Constant(domain.dofs(), -1);
  Number next = domain.rank() * of_process - 1;
  Index component = 0;
  for (Index i = 0; i < domain.dofs(); ++i) {
    component = starts(i) ? 0 : component + 1;
    if (!domain.owns(i)) continue;
    next += starts(i);
    number[i] = Real(next * dimension_ + component);
  }
  domain.update(number);
  for (Index i = 0; i < domain.dofs(); ++i) {
    of_[i] = static_cast<Number>(number[i]);
    if (starts(i)) add(node(of_[i]), i);
  }
}

}  // namespace frictioncg
