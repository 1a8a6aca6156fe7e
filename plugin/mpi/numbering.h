#pragma once
#include <petscsys.h>

#include <unordered_map>

#include "assembly/local_system.h"
#include "domain.h"

namespace frictioncg {

/// Where the local dofs of all processes lie in PETSc's vectors: node by node, `dimension` slots
/// each, so that smoothed aggregation sees blocks. Slots that Dirichlet conditions leave empty have
/// rows of their own diagonal; nodes without a free dof have none.
///
/// Local dofs are those of the overlapping system of this process, numbered as in its System; own
/// ones are those that it owns.
struct Numbering {
  /// mesh_node: of each dof of the script.   Collective.
  Numbering(const Domain& domain, const LocalSystem& local, const std::vector<Index>& mesh_node);

  Index slots() const { return dimension * static_cast<Index>(at.size()); }  ///< of this process
  bool is_own(Index local_dof) const {
    return slot[local_dof] >= first && slot[local_dof] < first + slots();
  }

  /// Of own contact dof c, from `first` on.
  Index contact_slot(std::size_t c) const { return own_slot[own_first.front() + c]; }

  Index dimension = 2;
  PetscInt first = 0;                  ///< its first slot
  std::vector<PetscInt> slot;          ///< of each local dof
  std::vector<std::vector<Index>> at;  ///< local dofs of each owned node, slot by slot
  std::vector<Index> own;              ///< local dofs owned: interior, then contact node by node
  std::vector<Index> own_slot;         ///< of each of these, from `first` on
  std::vector<Index> own_nodes;        ///< contact nodes owned, by their place in the local system
  std::vector<Index> own_first;        ///< as in System, among `own`
};

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
