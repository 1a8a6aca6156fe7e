#include "node_numbers.h"

namespace frictioncg {

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
