#pragma once
#include "../core/assembly/mortar/coupling.h"
#include "../core/assembly/mortar/geometric_stiffness.h"
#include "space.h"

namespace frictioncg {

/// Slaves and masters as their meshes have them, in one numbering of nodes: those of slaves first.
struct Interface {
  int d = 2;
  std::vector<Vec3> X;
  std::vector<Vec3> moved;  ///< of each node: the displacement that X has already
  bool is_moved = false;
  NodeDofs dof;
  std::vector<mortar::Pair> pairs;
  std::vector<SharedNode> slave;                     ///< the slaves' nodes
  std::function<std::vector<Index>()> slave_bodies;  ///< the body of each of them
  std::vector<Index> groups;                         ///< of elements at each node: mortar::Options
};

/// The labels of two bodies; those that this process's part of the meshes has, and all pairs.
struct PairLabels {
  std::vector<long> slave, master;
  std::vector<mortar::Pair> pairs;
};

/// The faces of two bodies in spaces of their own, or in one. Throws IllegalInput where a node of
/// theirs has two places: facets are seen from where their nodes are.
Interface interface_of(const Spaces& spaces, const PairLabels& labels);

/// Bodies 0, 1, ...: how many.
Index count_of(const std::vector<Index>& body);

/// Which rigid motions of bodies A leaves free: a body that A couples to another is not free of it.
/// body: of each node on the interface, or on obstacles; extent: of these nodes, roughly; places:
/// of all nodes.   Collective.
mortar::Freedom freedom_of(const Triplets& A, const Dirichlet& dirichlet,
                           const std::vector<NodePlace>& places, int d, const Extent& extent,
                           std::vector<Index> body, Index bodies,
                           const Processes& all = Processes());

/// A pair for reports.
struct FacingPair {
  std::string labels;                   ///< "label 1 on label 2"
  std::size_t slaves = 0, masters = 0;  ///< facets
  mortar::Statistics found;
  std::string held_at;  ///< a slave node whose normal Dirichlet conditions hold
};

/// What a mortar says of the slave's nodes.
struct FacedPart {
  std::vector<Real> gap, distance;     ///< of each contact point [length]
  std::vector<Real> own;               ///< SlaveNode::own of each
  std::vector<mortar::MidEdge> edges;  ///< by the nodes of the Interface
  std::vector<FacingPair> pairs;
  /// 0 at the points of other processes and of an obstacle, which follow.
  Real distance_at(std::size_t point) const {
    return point < distance.size() ? distance[point] : 0;
  }
  void add(const mortar::SlaveNode& m);
  void add(const mortar::Pair& pair, const mortar::Statistics& found, int d,
           const std::vector<Vec3>& X);
};

/// Contact of bodies with each other: their faces, and once A has told what Dirichlet conditions
/// hold, the mortar between them.
class Pairing {
 public:
  explicit Pairing(Interface between) : between_(std::move(between)) {}
  /// The contact nodes: those of the slave that face the master and are not on an obstacle, whose
  /// points are given. u_old, by all dofs or empty: where the increment began, of nodes that have
  /// been moved. again: the options are those of the last time, whose mortar stays where the same
  /// nodes are held and taken, and it depends on nothing else of A or of the increment.
  std::vector<BoundaryNode> face(const Triplets& A, mortar::Options options, const Vector& u_old,
                                 const std::vector<BoundaryNode>& on_obstacle,
                                 const std::function<std::vector<NodePlace>()>& places, bool again);
  void set(FacedPart faced) { faced_ = std::move(faced); }
  /// G U at each contact node, U empty where nothing has moved; and what their slip lacks of their
  /// motion, where the increment began elsewhere.
  static void add_motions(const mortar::Mortar& mortar, const std::vector<Vec3>& U,
                          std::vector<BoundaryNode>& contact);
  /// Node i of the slave with what a mortar makes of it.
  BoundaryNode contact_node(Index i, const mortar::SlaveNode& m) const;
  std::unique_ptr<LocalSystem> system(const Triplets& A, std::vector<ContactPoint> points,
                                      const std::vector<Index>& mesh_node, const BodyShape& shape,
                                      const LocalSystem* before) const;
  /// The slave's nodes.
  std::vector<BoundaryNode> slave_nodes() const;
  /// visit(i, node): the same for each label of theirs, where a gap is evaluated.
  template <class Visit>
  void for_each_label(const Visit& visit) const {
    for (std::size_t i = 0; i < between_.slave.size(); ++i) {
      std::set<long> seen;
      for (const AdjacentFacet& f : between_.slave[i].facets)
        if (seen.insert(f.label).second)
          visit(static_cast<Index>(i), slave_node(static_cast<Index>(i), f.label));
    }
  }
  /// The gap of each contact node: between the meshes, or as mortar::Mortar::weighted takes it.
  Vector gap() const;
  Vector gap(const std::vector<mortar::NodeGap>& given) const { return mortar_->weighted(given); }
  /// The symmetric part of the derivative of mortar::Options::force (n x n), between free dofs: a
  /// step does not change others.
  Matrix stiffness(Index n) const;
  Real told() const { return mortar_->told(); }
  /// Where U grows by v at the nodes.
  mortar::Change change(const std::vector<Vec3>& v) const;
  /// Values at the nodes by all n dofs: 0 where Dirichlet conditions hold, and elsewhere.
  Vector on_free_dofs(const std::vector<Vec3>& of_node, Index n) const;
  const Interface& between() const { return between_; }
  /// A displacement or force by the dofs of the script, at each node.
  std::vector<Vec3> at_nodes(const Vector& u) const;
  const FacedPart& faced() const { return faced_; }

 private:
  mortar::Nodes nodes_at(const Vector& u_old, const std::vector<ContactPoint>& obstacle) const;
  /// A node of the slave as one of its facets sees it, of the label if there is one.
  BoundaryNode slave_node(Index i, long label) const;

  Interface between_;
  std::shared_ptr<const Dirichlet> dirichlet_;
  std::vector<unsigned char> held_;  ///< of the nodes of the mortar, as mortar::Nodes has it
  std::vector<char> taken_;          ///< the same
  bool lasts_ = false;  ///< the mortar depends on no motion that A leaves free, nor on u_old
  /// Null where several processes have a common one.
  std::shared_ptr<const mortar::Mortar> mortar_;
  FacedPart faced_;
};

}  // namespace frictioncg
