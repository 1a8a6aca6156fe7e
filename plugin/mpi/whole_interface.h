#pragma once
#include "../freefem/pairing.h"
#include "numbering.h"

namespace frictioncg {

/// A node of the faces, as it is sent.
struct InterfaceNode {
  NodeNumbers::Number number;
  Vec3 X;
  unsigned char held;
  Index body;    ///< over all processes
  Index groups;  ///< of elements around it: mortar::Options
  Vec3 normal = Vec3::Zero();
  Real weight = 0;  ///< of slaves, where given, like the normal
  /// Where the geometry is moved: the displacement that X has already, uold, and forceold.
  Vec3 now = Vec3::Zero(), before = Vec3::Zero(), force = Vec3::Zero();
};

/// The faces of two bodies whole, the same on all processes in every bit and order: what they make
/// of it is the same, too. Nodes are sent by their owners, facets by the owner of their vertex with
/// the lowest number, around which it has all elements.
struct WholeInterface {
  /// part: what this process knows of them, with overlap; of_part: its nodes.   Collective.
  WholeInterface(const Domain& domain, const NodeNumbers& numbers, const Interface& part,
                 const std::vector<InterfaceNode>& of_part);

  Index count() const { return static_cast<Index>(nodes.size()); }
  /// One of their values at all nodes.
  template <class T>
  std::vector<T> at_all(T InterfaceNode::*value) const {
    std::vector<T> values;
    for (const InterfaceNode& n : nodes) values.push_back(n.*value);
    return values;
  }
  /// Gaps at the part's slave nodes, in their order, as their owners see them.   Collective.
  std::vector<mortar::NodeGap> gathered(const Domain& domain,
                                        const std::vector<mortar::NodeGap>& of_part) const;
  /// A displacement by the part's dofs, as owners have it, at all nodes; 0 at those that no facet
  /// names.   Collective.
  std::vector<Vec3> at_nodes(const Domain& domain, const Vector& u) const;
  /// Values at the nodes by n dofs of the part: 0 where Dirichlet conditions hold, at those of
  /// others, and elsewhere.
  Vector on_free_dofs(const std::vector<Vec3>& of_node, Index n) const;

  Index d = 2;
  std::vector<InterfaceNode> nodes;  ///< those of slaves come first
  Index slaves = 0;
  std::unordered_map<NodeNumbers::Number, Index> at;  ///< of each number, the node
  std::vector<mortar::Pair> pairs;

 private:
  void gather_nodes(const Domain& domain, const NodeNumbers& numbers, const Interface& part,
                    const std::vector<InterfaceNode>& of_part);
  void gather_facets(const Domain& domain, const NodeNumbers& numbers, const Interface& part);
  void find_one_body();
  void find_own(const Domain& domain, const NodeNumbers& numbers);

  std::vector<Index> own_slaves_;  ///< of the part: which of all; -1: another process owns it
  std::vector<Index> own_dof_;     ///< of each node, its first; -1: another's, or no facet names it
};

}  // namespace frictioncg
