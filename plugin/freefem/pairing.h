#pragma once
#include "freefem.h"

#include "../core/assembly/mortar/geometric_stiffness.h"
#include "../core/assembly/mortar/slip.h"
#include "../core/assembly/mortar/validation.h"
#include "freedom.h"
#include "interface.h"

namespace frictioncg {

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
  std::vector<mortar::MidEdge> edges;  ///< by the nodes of the Interface
  std::vector<FacingPair> pairs;

  void add(const mortar::ContactNode& m) {
    gap.push_back(m.gap);
    distance.push_back(m.distance);
  }
  void add(const mortar::Pair& pair, const mortar::Statistics& found, int d,
           const std::vector<mortar::Vec3>& X) {
    pairs.push_back({mortar::labels_of(pair.slave) + " on " + mortar::labels_of(pair.master),
                     pair.slave.facets.size(), pair.master.facets.size(), found,
                     found.held > 0 ? mortar::place(d, X[found.first_held]) : ""});
  }
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
  std::vector<BoundaryNode> face(const Triplets& A, int d, mortar::Options options,
                                 const Vector& u_old, const std::vector<BoundaryNode>& on_obstacle,
                                 const std::function<std::vector<NodePlace>()>& places,
                                 bool again = false) {
    std::vector<ContactPoint> obstacle;
    for (const BoundaryNode& n : on_obstacle) obstacle.push_back(n.point);
    dirichlet_ = std::make_shared<const Dirichlet>(A, obstacle);
    bool asked = false;
    add_bodies(A, d, places, options, asked);
    const mortar::Nodes nodes = nodes_at(d, u_old, obstacle);
    const bool stays =
        again && lasts_ && u_old.size() == 0 && nodes.held == held_ && nodes.taken == taken_;
    if (!stays) {
      mortar_ = std::make_shared<const mortar::Mortar>(nodes, between_.pairs, options);
      lasts_ = !asked && u_old.size() == 0;
      held_ = nodes.held;
      taken_ = nodes.taken;
    }
    std::vector<BoundaryNode> contact;
    FacedPart faced;
    for (const mortar::ContactNode& m : mortar_->nodes()) {
      contact.push_back(contact_node(m.node, m));
      faced.add(m);
    }
    add_moved(*mortar_, between_.moved, contact);
    add_slip(*mortar_, contact);
    for (const mortar::MidEdge& e : mortar_->edges()) add_edge(e, faced);
    for (std::size_t p = 0; p < between_.pairs.size(); ++p)
      faced.add(between_.pairs[p], mortar_->statistics(static_cast<Index>(p)), d, between_.X);
    set(std::move(faced));
    return contact;
  }
  void set(FacedPart faced) { faced_ = std::move(faced); }

  /// G U at each contact node.
  static void add_moved(const mortar::Mortar& mortar, const std::vector<mortar::Vec3>& U,
                        std::vector<BoundaryNode>& contact) {
    for (std::size_t k = 0; k < contact.size(); ++k)
      for (Matrix::InnerIterator G(mortar.relative(), static_cast<Index>(k)); G; ++G)
        for (int c = 0; c < 3; ++c) contact[k].moved[c] += G.value() * U[G.col()][c];
  }

  /// What their slip lacks of their motion, where the increment began elsewhere.
  static void add_slip(const mortar::Mortar& mortar, std::vector<BoundaryNode>& contact) {
    for (std::size_t k = 0; k < mortar.slip().size(); ++k)
      for (int c = 0; c < 3; ++c) contact[k].slid[c] = mortar.slip()[k][c];
  }

  /// Node i of the slave with what a mortar makes of it.
  BoundaryNode contact_node(Index i, const mortar::ContactNode& m) const {
    BoundaryNode node = slave_node(i, m.label);
    for (int c = 0; c < 3; ++c) node.point.normal[c] = m.normal[c];
    node.mean = as_R3(node.point.normal);
    node.weight = m.weight;
    return node;
  }

  std::unique_ptr<LocalSystem> system(const Triplets& A, int d, std::vector<ContactPoint> points,
                                      const std::vector<Index>& mesh_node, const RigidModes& modes,
                                      const RigidModes& body_modes,
                                      const LocalSystem* before) const {
    const Coupling coupling = mortar::couple(*mortar_, d, between_.dof, *dirichlet_, A.n, taken_);
    return std::make_unique<LocalSystem>(A, d, std::move(points), mesh_node, *dirichlet_, coupling,
                                         modes, body_modes, before);
  }

  /// The slave's nodes, where a gap is evaluated.
  std::vector<BoundaryNode> slave_nodes() const {
    std::vector<BoundaryNode> nodes;
    for (std::size_t i = 0; i < between_.slave.size(); ++i)
      nodes.push_back(slave_node(static_cast<Index>(i), between_.slave[i].facets.front().label));
    return nodes;
  }
  /// The gap of each contact node: between the meshes, or as given at each slave node.
  Vector gap() const {
    return Eigen::Map<const Vector>(faced_.gap.data(), static_cast<Index>(faced_.gap.size()));
  }
  Vector gap(const Vector& given) const {
    Vector at_nodes = Vector::Zero(static_cast<Index>(between_.X.size()));
    at_nodes.head(given.size()) = given;
    return mortar_->weighted(at_nodes);
  }
  /// 0 at the points of other processes and of an obstacle, which follow.
  Real distance(std::size_t point) const {
    return point < faced_.distance.size() ? faced_.distance[point] : 0;
  }

  /// The symmetric part of the derivative of mortar::Options::force (n x n), between free dofs: a
  /// step does not change others.
  Matrix stiffness(Index n, int d) const {
    std::vector<Eigen::Triplet<Real, Index>> entries;
    mortar_->stiffness().for_each_symmetric(d, [&](Index i, int a, Index j, int b, Real s) {
      const Index k = between_.dof[i][a], l = between_.dof[j][b];
      if (!dirichlet_->holds(k) && !dirichlet_->holds(l)) entries.emplace_back(k, l, s);
    });
    Matrix S(n, n);
    S.setFromTriplets(entries.begin(), entries.end());
    return S;
  }

  /// Where U grows by v at the nodes.
  mortar::Change change(const std::vector<mortar::Vec3>& v, int d) const {
    return mortar::change(*mortar_, v, mortar::straightened(d, between_.pairs, v));
  }
  /// Values at the nodes by all n dofs: 0 where Dirichlet conditions hold, and elsewhere.
  Vector on_free_dofs(const std::vector<mortar::Vec3>& of_node, Index n, int d) const {
    Vector of_dof = Vector::Zero(n);
    for (std::size_t i = 0; i < of_node.size(); ++i)
      for (int c = 0; c < d; ++c)
        if (const Index k = between_.dof[i][c]; !dirichlet_->holds(k)) of_dof[k] = of_node[i][c];
    return of_dof;
  }

  const Interface& between() const { return between_; }
  /// Of the Interface, by the places of all nodes of the n dofs.
  std::vector<Index> body_of_nodes(const std::vector<NodePlace>& places, Index n) const {
    std::vector<Index> of_dof(n, 0), body;
    for (const NodePlace& p : places) of_dof[p.dof[0]] = p.body;
    for (const auto& dof : between_.dof) body.push_back(of_dof[dof[0]]);
    return body;
  }
  /// A force by the dofs of the script, at each node.
  std::vector<mortar::Vec3> at_nodes(const Vector& force, int d) const {
    std::vector<mortar::Vec3> of_node(between_.dof.size(), mortar::Vec3::Zero());
    for (std::size_t i = 0; i < of_node.size(); ++i)
      for (int c = 0; c < d; ++c) of_node[i][c] = force[between_.dof[i][c]];
    return of_node;
  }
  const std::vector<mortar::MidEdge>& edges() const { return faced_.edges; }
  const std::vector<FacingPair>& pairs() const { return faced_.pairs; }

 private:
  /// What the mortar asks of the bodies; asked: set where it does so of motions that A leaves free.
  void add_bodies(const Triplets& A, int d, const std::function<std::vector<NodePlace>()>& places,
                  mortar::Options& options, bool& asked) const {
    options.element_groups = [this](Index i) {
      const auto found = between_.body_count.find(i);
      return found == between_.body_count.end() ? 1 : found->second;
    };
    options.bodies = between_.slave_bodies;
    options.freedom = [this, &A, d, &places, &asked] {
      asked = true;
      const std::vector<NodePlace> all = places();
      const std::vector<Index> body = body_of_nodes(all, A.n);
      FreedomOfBodies bodies(d, extent_of(between_.X), body, count_of(body));
      bodies.add(A, *dirichlet_, all);
      return bodies.freedom();
    };
  }
  mortar::Nodes nodes_at(int d, const Vector& u_old,
                         const std::vector<ContactPoint>& obstacle) const {
    mortar::Nodes nodes{d, between_.X, mortar::held_components(d, between_.dof, *dirichlet_),
                        taken_by(obstacle)};
    if (between_.is_moved) nodes.reference = displaced(between_, d);
    if (u_old.size() > 0) nodes.before = displaced(between_, d, u_old);
    return nodes;
  }
  /// The nodes that an obstacle has; none where there is no obstacle.
  std::vector<char> taken_by(const std::vector<ContactPoint>& obstacle) const {
    std::vector<char> taken;
    if (obstacle.empty()) return taken;
    std::set<Index> dofs;
    for (const ContactPoint& p : obstacle) dofs.insert(p.dof[0]);
    for (const std::array<Index, 3>& dof : between_.dof) taken.push_back(dofs.count(dof[0]) > 0);
    return taken;
  }
  /// A mid-edge is the pair's, between ends of which an obstacle has one at most.
  void add_edge(mortar::MidEdge e, FacedPart& faced) const {
    const auto taken = [this](Index node) { return !taken_.empty() && taken_[node]; };
    if (taken(e.node) || (taken(e.a) && taken(e.b))) return;
    if (taken(e.a)) e.a = e.b;
    if (taken(e.b)) e.b = e.a;
    faced.edges.push_back(e);
  }
  /// A node of the slave as one of its facets sees it, of the label if there is one.
  BoundaryNode slave_node(Index i, long label) const {
    const SharedNode& shared = between_.slave[i];
    const AdjacentFacet* facet = &shared.facets.front();
    for (const AdjacentFacet& f : shared.facets)
      if (f.label == label) {
        facet = &f;
        break;
      }
    BoundaryNode node;
    node.point.dof = shared.dof;
    const Fem2D::R3 n = facet->normal / Norme2(facet->normal);
    node.point.normal = {n.x, n.y, n.z};
    node.x = shared.x;
    node.label = facet->label;
    node.element = facet->element;
    node.facet = facet->facet;
    node.hat = facet->hat;
    return node;
  }

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
