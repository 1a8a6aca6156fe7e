#pragma once
#include <cstdint>
#include <unordered_map>

#include "domain.h"

namespace frictioncg {

/// Numbers of nodes, and of their dofs, that all processes call alike: each counts its own nodes
/// from its rank's first number on, and they have `dimension` numbers of dofs each. A double has
/// them exactly.
class NodeNumbers {
 public:
  using Number = std::int64_t;

  /// mesh_node: of each dof of the part; the dofs of a node follow each other.   Collective.
  NodeNumbers(const Domain& domain, Index dimension, const std::vector<Index>& mesh_node);

  Number of(Index dof) const { return of_[dof]; }  ///< of a dof of the part
  Number node(Number dof) const { return dof / dimension_; }
  Index component(Number dof) const { return static_cast<Index>(dof % dimension_); }
  int owner(Number node) const { return static_cast<int>(node / of_process); }
  bool is_here(Number node) const { return first_dof_.count(node) > 0; }
  Index dof(Number node, Index component) const { return first_dof_.at(node) + component; }
  Index dof(Number number) const { return dof(node(number), component(number)); }

  void add(Number node, Index first_dof) { first_dof_.emplace(node, first_dof); }

 private:
  static constexpr Number of_process = Number(1) << 30;  ///< nodes, at most: an Index counts dofs

  Index dimension_;
  std::vector<Number> of_;
  std::unordered_map<Number, Index> first_dof_;  ///< of each node that is here
};

}  // namespace frictioncg
