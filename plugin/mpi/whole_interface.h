#pragma once
#include "assembly/mortar/coupling.h"
#include "node_numbers.h"

namespace frictioncg {

/// Of each node of a geometry that is moved; empty where it is not.
struct Motion {
  std::vector<Vec3> now;     ///< the displacement that X has already
  std::vector<Vec3> before;  ///< uold
  std::vector<Vec3> force;   ///< forceold
};

/// What a process knows of the faces of two bodies: its own part with overlap.
struct InterfacePart {
  std::vector<Vec3> X;
  mortar::NodeDofs dof;
  std::vector<mortar::Pair> pairs;  ///< the same on all processes, but for their facets
  Index slaves = 0;                 ///< nodes: those of slaves come first
  std::vector<unsigned char> held;
  std::vector<Index> body;                 ///< of each node, over all processes
  std::vector<Index> groups;               ///< of elements around it: mortar::Options
  std::vector<std::vector<Real>> options;  ///< of each slave node: normal and weight, where given
  bool is_moved = false;                   ///< the same on all processes
  Motion motion;
};

/// The faces of two bodies whole, the same on all processes in every bit and order: what they make
/// of it is the same, too. Nodes are sent by their owners, facets by the owner of their vertex with
/// the lowest number, around which it has all elements.
struct WholeInterface {
  /// Collective.
  WholeInterface(const Domain& domain, const NodeNumbers& numbers, Index dimension,
                 const InterfacePart& part);

  Index nodes() const { return static_cast<Index>(number.size()); }
  /// A value at each of the part's slave nodes, by their owners, at all slave nodes.   Collective.
  Vector gathered(const Domain& domain, const Vector& at_part) const;
  /// A displacement by the part's dofs, as owners have it, at all nodes; 0 at those that no facet
  /// names.   Collective.
  std::vector<Vec3> at_nodes(const Domain& domain, const Vector& u) const;
  /// Values at the nodes by n dofs of the part: 0 where Dirichlet conditions hold, at those of
  /// others, and elsewhere.
  Vector on_free_dofs(const std::vector<Vec3>& of_node, Index n) const;

  Index d = 2;
  std::vector<NodeNumbers::Number> number;            ///< of each node; those of slaves come first
  std::unordered_map<NodeNumbers::Number, Index> at;  ///< and back
  std::vector<Vec3> X;
  std::vector<unsigned char> held;
  std::vector<Index> body, groups;
  std::vector<std::vector<Real>> options;  ///< of each slave node
  Motion motion;
  std::vector<mortar::Pair> pairs;

 private:
  void gather_nodes(const Domain& domain, const NodeNumbers& numbers, const InterfacePart& part);
  void gather_facets(const Domain& domain, const NodeNumbers& numbers, const InterfacePart& part);
  void find_one_body();
  void find_own(const Domain& domain, const NodeNumbers& numbers);

  std::vector<Index> own_slaves_;  ///< of the part, that this process owns
  std::vector<Index> own_dof_;     ///< of each node, its first; -1: another's, or no facet names it
};

}  // namespace frictioncg
