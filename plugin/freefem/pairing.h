#pragma once
#include "freefem.h"

#include <memory>

#include "interface.h"

namespace frictioncg {

/// Contact of bodies with each other: their faces, and once A has told what Dirichlet conditions
/// hold, the mortar between them.
class Pairing {
 public:
  explicit Pairing(Interface between) : between_(std::move(between)) {}

  /// The contact nodes: those of the slave that face the master.
  std::vector<BoundaryNode> face(const Triplets& A, int d, mortar::Options options) {
    options.element_groups = [this](Index i) {
      const auto found = between_.body_count.find(i);
      return found == between_.body_count.end() ? 1 : found->second;
    };
    options.bodies = between_.slave_bodies;
    dirichlet_ = std::make_unique<Dirichlet>(A, std::vector<ContactPoint>{});
    const mortar::Nodes nodes{d, between_.X, mortar::held_components(d, between_.dof, *dirichlet_)};
    mortar_ = std::make_unique<mortar::Mortar>(nodes, between_.pairs, options);
    std::vector<BoundaryNode> contact;
    const std::vector<ContactPoint> points = mortar::contact_points(*mortar_, between_.dof);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const mortar::ContactNode& m = mortar_->nodes()[k];
      BoundaryNode node = slave_node(m.node, m.label);
      node.point = points[k];
      node.mean = as_R3(node.point.normal);
      node.weight = m.weight;
      contact.push_back(node);
    }
    return contact;
  }

  std::unique_ptr<LocalSystem> system(const Triplets& A, int d, std::vector<ContactPoint> points,
                                      const std::vector<Index>& mesh_node, const RigidModes& modes,
                                      const RigidModes& body_modes) const {
    const Coupling coupling = mortar::couple(*mortar_, d, between_.dof, *dirichlet_, A.n);
    return std::make_unique<LocalSystem>(A, d, std::move(points), mesh_node, *dirichlet_, coupling,
                                         modes, body_modes);
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
    Vector gap(static_cast<Index>(mortar_->nodes().size()));
    for (Index k = 0; k < gap.size(); ++k) gap[k] = mortar_->nodes()[k].gap;
    return gap;
  }
  Vector gap(const Vector& given) const {
    Vector at_nodes = Vector::Zero(static_cast<Index>(between_.X.size()));
    at_nodes.head(given.size()) = given;
    return mortar_->weighted(at_nodes);
  }
  Real distance(Index point) const { return mortar_->nodes()[point].distance; }

  const Interface& between() const { return between_; }
  const std::vector<mortar::MidEdge>& edges() const { return mortar_->edges(); }
  const mortar::Statistics& statistics(Index pair) const { return mortar_->statistics(pair); }

 private:
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
  std::unique_ptr<Dirichlet> dirichlet_;
  std::unique_ptr<mortar::Mortar> mortar_;
};

}  // namespace frictioncg
