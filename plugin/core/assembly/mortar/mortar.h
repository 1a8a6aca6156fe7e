#pragma once
#include "assembly/mortar/surface.h"
#include "assembly/slippable.h"

namespace frictioncg::mortar {

/// X with the mid-edges of P2 in the middle of their straight edges, as facets have them.
std::vector<Vec3> straightened(int d, const std::vector<Pair>& pairs, std::vector<Vec3> X);

/// The nodes that facets name.
struct Nodes {
  int dimension = 2;    ///< 2 or 3
  std::vector<Vec3> X;  ///< position [length]; P2's mid-edges may lie beside their edges
  std::vector<unsigned char> held;  ///< bit c: component c has a Dirichlet condition; empty: none
  std::vector<char> taken = {};     ///< obeys an obstacle, and no law of a pair; empty: none
  /// Where the bodies are not deformed, which tells edges from smooth surfaces; empty: X.
  std::vector<Vec3> reference = {};
  /// Where the increment began, which decides what faces what and who carries the laws
  /// (cover.h, ownership.h); empty: X.
  std::vector<Vec3> before = {};
  /// Of the Mortar, with P2 and a reference: as X was given, which then is straight. Forces act
  /// there, and gaps are between bent edges.   empty: X
  std::vector<Vec3> bent = {};
  const std::vector<Vec3>& where_forces_act() const { return bent.empty() ? X : bent; }
};

/// How bodies may move as a whole.
struct Freedom {
  RigidGenerators generators;
  std::vector<Index> body;           ///< of each node
  std::vector<DenseMatrix> of_body;  ///< what nothing but contact resists, as columns of generators
  std::vector<DenseMatrix> stiffness;  ///< of A and supports, between generators [force/length]
  std::vector<DenseMatrix> support;    ///< of supports alone; or empty: there are none
};

struct Options {
  Real maxgap = infinity;  ///< partners are no further apart [length]
  bool smooth = true;      ///< the gap is that of the curved surfaces through the vertices
  /// Outward from the slave, of any length > 0, at its nodes, which come first; empty: the mesh's.
  std::vector<Vec3> normals;
  /// Of the integrals, >= 0, at the slave's nodes, which come first; linear on a facet; empty: 1.
  std::vector<Real> weight;
  /// The body of each of the slave's nodes, 0, 1, ...; asked for curved slaves; without it all are
  /// one.
  std::function<std::vector<Index>()> bodies;
  /// Asked for where a flat face is before a curved one, or a part of a pair lies flat and another
  /// may not; without it the slave's normals count.
  std::function<Freedom()> freedom;
  /// How many facet-connected groups the elements around a node form; asked for nodes that are both
  /// slave and master: one at the tip of a crack, more where meshes were merged.
  std::function<Index(Index node)> element_groups;
  /// Of contact on the bodies, at each node, some time ago: whose change with the geometry is asked
  /// for. Empty: it is not.
  std::vector<Vec3> force;
};

/// A node of the slave that carries the laws, in w_i = (G u)_i: w.n <= gap.
struct SlaveNode {
  Index node = 0;
  Index pair = 0;
  long label = 0;
  Vec3 normal = Vec3::Zero();  ///< unit, outward from the slave, free of held components
  Real weight = 0;             ///< D_i, its share of the covered boundary, weighted
  Real gap = 0;                ///< [length]
  Real distance = 0;           ///< the gap as a distance: differs where a neighbour is removed
  Real own = 1;                ///< the weights of the slave in its law, removed nodes' with its own
};

/// A mid-edge of a P2 slave that something faces, between the vertices a and b.
struct MidEdge {
  Index node = 0, a = 0, b = 0;
  Real distance = 0;  ///< [length]
};

/// A gap at a slave's node, as on its facets of a label.
struct NodeGap {
  Index node = 0;
  long label = 0;
  Real gap = 0;  ///< [length]
};

/// A derivative with respect to the places of nodes, as a sum: force at the node of the row, place
/// of the node of the column.
using NodeBlocks = std::vector<std::pair<std::pair<Index, Index>, Eigen::Matrix3d>>;

/// How contact changes with the places of nodes.
struct GeometricStiffness {
  NodeBlocks forces;  ///< d(G'y)/dX
  NodeBlocks bent;    ///< what it has more by the way of P2's mid-edges from their straight edges
  /// dg_k/dX_j by (k, j), of the contact nodes k that a force loads.
  std::vector<std::pair<std::pair<Index, Index>, Vec3>> gaps;
  /// What these have more by the way of mid-edges from their straight edges.
  std::vector<std::pair<std::pair<Index, Index>, Vec3>> bent_gaps;

  /// visit(i, a, j, b, s): the symmetric part, s between component a of node i and b of j, in
  /// terms.
  template <class Visit>
  void for_each_symmetric(int d, const Visit& visit) const {
    for (const auto& [nodes, block] : forces)
      for (int a = 0; a < d; ++a)
        for (int b = 0; b < d; ++b) {
          visit(nodes.first, a, nodes.second, b, block(a, b) / 2);
          visit(nodes.second, b, nodes.first, a, block(a, b) / 2);
        }
  }
};

/// What the search has found of one pair.
struct Statistics {
  Index facing = 0;          ///< contact nodes
  Index removed = 0;         ///< slave vertices with something before them that carry no law
  Index held = 0;            ///< those of them whose normal Dirichlet conditions hold
  Index first_held = -1;     ///< one of the latter
  Index held_facets = 0;     ///< covered slave facets whose vertices are all of these
  Index partly_covered = 0;  ///< slave facets
  Real least_gap = 0, largest_gap = 0;
  std::size_t visited = 0;  ///< steps of the search
};

/// Dual mortar between surfaces that do not match, as a change of basis u = T w, the same for every
/// component: w_i of a contact node is its displacement relative to a weighted mean of the master,
/// other w are displacements, and laws hold node by node.   Wohlmuth; Popp et al.
///
///   D_i = sum d_i,   N_ir = int psi_i phi~_r / D_i,   P_il = int psi_i phi^m_l(chi) / D_i
///   G = (I + N) C^-1 - P,   T = C (I + N - P C L)^-1 (I + P C (I - L))
///
/// i: contact nodes, L takes them, r: other slave nodes (no vertices where the normal of i is the
/// master's, see Assembly::place_removed), l: master nodes, of which an earlier pair may have made
/// contact nodes. C: u_e = u~_e + (u~_a + u~_b)/2 at the
/// mid-edges of a P2 slave, whose trace functions phi~ then are the hats of the vertices, and
/// phi_e.
class Mortar {
 public:
  /// Throws IllegalInput for surfaces that make no contact, with one sentence for the user.
  Mortar(const Nodes& nodes, const std::vector<Pair>& pairs, const Options& options = {});

  const std::vector<SlaveNode>& nodes() const { return nodes_; }  ///< m
  const std::vector<MidEdge>& edges() const { return edges_; }
  const Matrix& relative() const { return G_; }  ///< m x nodes; forces on both bodies are G'y
  /// What the slip of each contact node lacks of its motion since Nodes::before; empty
  /// where that is, and where normals are given: those of now, which the mortar of before cannot
  /// have.
  const std::vector<Vec3>& slip() const { return slip_; }
  /// Of Options::force, whose y turn with the normals; see geometric_stiffness.h.
  const GeometricStiffness& stiffness() const { return stiffness_; }
  const Statistics& statistics(Index pair = 0) const { return statistics_[pair]; }
  /// Slips::told of the slaves' normals, the largest; 0 where they let nothing slip.
  Real told() const { return told_; }

  /// T, nodes x nodes, with rows of the identity where held (empty: nowhere): for the components
  /// with Dirichlet conditions at some nodes.
  Matrix change_of_basis(const std::vector<char>& held = {}) const;

  /// Its inverse: the rows of G at contact nodes, of C^-1 at mid-edges, of the identity elsewhere.
  Matrix inverse_basis(const std::vector<char>& held = {}) const;

  /// The gap of each contact node (m), from one given at every slave node, once for each label that
  /// it has, one after the other: a node in a corner is seen from either face.
  Vector weighted(const std::vector<NodeGap>& given) const;

 private:
  Mortar() = default;
  Matrix halving(const std::vector<char>& held, bool where_held, Real half) const;

  Index size_ = 0;
  std::vector<SlaveNode> nodes_;
  std::vector<MidEdge> edges_;             ///< of C
  Matrix N_, P_;                           ///< nodes x nodes, rows of contact nodes
  Matrix S_, G_;                           ///< m x nodes: (I + N) C^-1, and S - P
  std::vector<Statistics> statistics_;     ///< per pair given
  std::vector<std::vector<long>> labels_;  ///< of the slaves, per parted pair
  std::vector<Vec3> slip_;
  Real told_ = 0;
  GeometricStiffness stiffness_;

  friend class Assembly;
};

}  // namespace frictioncg::mortar
