#pragma once
#include "freefem.h"

#include "../core/assembly/axisymmetry.h"
#include "node_values.h"
#include "report.h"

namespace frictioncg {

/// A vertex of a facet as a place where to evaluate expressions.
inline BoundaryNode vertex_of(const AdjacentFacet& facet, int v) {
  BoundaryNode node;
  node.label = facet.label;
  node.element = facet.element;
  node.facet = facet.facet;
  node.hat = Fem2D::R3(v == 1, v == 2, v == 3);
  const Fem2D::R3 n = facet.normal / Norme2(facet.normal);
  node.point.normal = {n.x, n.y, n.z};
  return node;
}

/// The integral of weight times the shape function of a facet's node, the weight being linear
/// between the facet's vertices: those of the element but the one that the facet lies opposite.
inline double weighted_share(Stack stack, const Arguments& args, const Scene& scene,
                             MeshPoint* point, const AdjacentFacet& facet) {
  const Fem2D::R3& hat = facet.hat;
  const double lambda[4] = {1 - hat.x - hat.y - hat.z, hat.x, hat.y, hat.z};
  double at_node = 0, mean = 0;
  for (int v = 0; v <= scene.d; ++v) {
    if (v == facet.facet) continue;
    BoundaryNode vertex = vertex_of(facet, v);
    scene.go_to(point, vertex);
    const double weight = args.value<double>(stack, p_weight);
    vertex.x = point->P;
    check_value(p_weight, weight, vertex, scene.d);
    at_node += lambda[v] * weight;
    mean += weight / scene.d;
  }
  return facet.share * (facet.own * at_node + (1 - facet.own) * mean);
}

/// Weights the shares of the contact points on an obstacle, by which tractions are multiplied.
inline void set_weights(Stack stack, const Arguments& args, Scene& scene) {
  if (!args.has(p_weight)) return;
  PointGuard guard(stack);
  for (BoundaryNode& node : scene.nodes) {
    node.weight = 0;
    for (const AdjacentFacet& facet : node.facets)
      node.weight += weighted_share(stack, args, scene, guard.point(), facet);
  }
}

/// The weight of the mortar at the slave's nodes; empty where none is named.
inline std::vector<Real> slave_weights(Stack stack, const Arguments& args, const Scene& scene) {
  if (!args.has(p_weight)) return {};
  const Vector w = at_nodes(stack, args, p_weight, scene, scene.pairing->slave_nodes());
  return {w.data(), w.data() + w.size()};
}

/// The radius of forms that look axisymmetric, as a component, where contact does not know it: no
/// weight is named, and pressures or limits are integrated. Else -1.
inline int unnamed_radius(const Arguments& args, const Scene& scene, const Triplets& A) {
  if (scene.d == 3 || args.has(p_weight) || scene.nodes.empty()) return -1;
  if (!scene.pairing && !args.has_any(tractions)) return -1;
  const int c = radial_component(A, scene.mesh_node);
  if (c < 0) return -1;
  Real least = 0, most = 0;
  for (const BoundaryNode& n : scene.nodes) {
    const Real r = c == 0 ? n.x.x : n.x.y;
    least = std::min(least, r);
    most = std::max(most, r);
  }
  const Real axis = 1e-10 * (most - least);
  return least >= -axis || most <= axis ? c : -1;
}

inline void note_weight(const Scene& scene) {
  if (scene.unnamed_radius < 0) return;
  const char* const r = scene.unnamed_radius == 0 ? "x" : "y";
  line() << "note: A looks axisymmetric, with the radius " << r << ", and no weight is named; "
         << "give weight=" << r << std::endl;
}

}  // namespace frictioncg
