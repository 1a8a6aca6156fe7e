#include "node_values.h"

#include "../core/assembly/axisymmetry.h"

namespace frictioncg {

namespace {

/// Refuses a value at a node, which is named.
void check_value(Parameter p, double x, const BoundaryNode& node, int d) {
  const bool is_gap = p == p_gap || p == p_obstaclegap;
  if (std::isfinite(x) && (is_gap || x >= 0)) return;
  refuse(name_of(p), " = ", x, " at ", place(node, d), "; ",
         (p == p_mu || p == p_mu2 ? "a friction coefficient is a number >= 0"
          : is_gap                ? "a gap is a finite length"
          : p == p_weight         ? "a weight is a number >= 0"
          : p == p_cohesion       ? "a cohesion is a traction >= 0"
          : p == p_shearmax       ? "the largest shear is a traction >= 0"
                                  : "a sliding limit is a traction >= 0"));
}

/// The bound on n.w at each contact point: the gap, which replaces that of the meshes where it is
/// given, with what has been moved already. before: that of the contactproblem, or empty; what the
/// call does not name has it.
Vector read_gap(Stack stack, const Arguments& args, const Scene& scene, const Vector& before) {
  const Vector moved = moved_along_normals(scene);
  if (!scene.pairing) return at_nodes(stack, args, p_gap, scene.nodes) + moved;
  const Index paired = static_cast<Index>(scene.paired()), beside = moved.size() - paired;
  Vector gap = before;
  gap.conservativeResize(moved.size());
  const Pairing& pairs = *scene.pairing;
  if (args.has(p_gap) || before.size() == 0)
    gap.head(paired) = moved.head(paired) +
                       (args.has(p_gap) ? pairs.gap(given_gap(stack, args, pairs)) : pairs.gap());
  const std::vector<BoundaryNode> on_obstacle(scene.nodes.begin() + paired, scene.nodes.end());
  if (args.has(p_obstaclegap) || before.size() == 0)
    gap.tail(beside) = at_nodes(stack, args, p_obstaclegap, on_obstacle) + moved.tail(beside);
  return gap;
}

/// The values of a vector, p, at a node, scaled to length 1; 0 where it has no direction.
Vec3 unit_vector(Stack stack, const Arguments& args, Parameter p, const BoundaryNode& node) {
  node.space->go_to(stack, node);
  Vec3 n = Vec3::Zero();
  double norm = 0;
  for (int c = 0; c < node.space->d; ++c) {
    n[c] = args.component(stack, p, c);
    norm = std::hypot(norm, n[c]);
  }
  return norm > 0 && std::isfinite(norm) ? Vec3(n / norm) : Vec3(Vec3::Zero());
}

/// Whether another point of the node has the opposite normal, as at a tip midway between two
/// plates, which faces both alike: one of them does.
bool has_opposite(const std::vector<BoundaryNode>& points, const BoundaryNode& node) {
  constexpr Real opposite = 1e-3;
  for (auto p = points.rbegin(); p != points.rend() && p->point.dof == node.point.dof; ++p)
    if (length(p->point.normal + node.point.normal) < opposite) return true;
  return false;
}

/// A traction at each contact node, as a force.
Vector forces_at_nodes(Stack stack, const Arguments& args, Parameter p, const Scene& scene) {
  Vector force = at_nodes(stack, args, p, scene.nodes);
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) force[k] *= scene.nodes[k].weight;
  return force;
}

/// The integral of weight times the shape function of a facet's node, the weight being linear
/// between the facet's vertices: those of the element but the one that the facet lies opposite.
double weighted_share(Stack stack, const Arguments& args, const AdjacentFacet& facet) {
  const int d = facet.space->d;
  const Vec3& hat = facet.hat;
  const double lambda[4] = {1 - hat[0] - hat[1] - hat[2], hat[0], hat[1], hat[2]};
  double at_node = 0, mean = 0;
  for (int v = 0; v <= d; ++v) {
    if (v == facet.facet) continue;
    BoundaryNode vertex{facet};
    vertex.hat = Vec3(v == 1, v == 2, v == 3);
    vertex.point.normal = facet.normal / length(facet.normal);
    vertex.x = facet.space->go_to(stack, vertex);
    const double weight = args.value<double>(stack, p_weight);
    check_value(p_weight, weight, vertex, d);
    at_node += lambda[v] * weight;
    mean += weight / d;
  }
  return facet.share * (facet.own * at_node + (1 - facet.own) * mean);
}

}  // namespace

Vector at_nodes(Stack stack, const Arguments& args, Parameter p,
                const std::vector<BoundaryNode>& nodes) {
  Vector result = Vector::Zero(static_cast<Index>(nodes.size()));
  if (!args.has(p)) return result;
  const auto guard = point_guard(stack);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    nodes[k].space->go_to(stack, nodes[k]);
    result[k] = args.value<double>(stack, p);
    check_value(p, result[k], nodes[k], nodes[k].space->d);
  }
  return result;
}

std::vector<mortar::NodeGap> given_gap(Stack stack, const Arguments& args, const Pairing& pairs) {
  std::vector<mortar::NodeGap> gaps;
  std::vector<BoundaryNode> nodes;
  pairs.for_each_label([&](Index i, const BoundaryNode& node) {
    gaps.push_back({i, node.label, 0});
    nodes.push_back(node);
  });
  const Vector at = at_nodes(stack, args, p_gap, nodes);
  for (std::size_t k = 0; k < gaps.size(); ++k) gaps[k].gap = at[static_cast<Index>(k)];
  return gaps;
}

Vector moved_along_normals(const Scene& scene) {
  Vector moved(scene.nodes.size());
  for (Index k = 0; k < moved.size(); ++k)
    moved[k] = dot(scene.nodes[k].moved, scene.nodes[k].point.normal);
  return moved;
}

bool faces_away(const BoundaryNode& node, const Vec3& n) { return dot(node.mean, n) < -1e-6; }

void set_normals(Stack stack, const Arguments& args, Scene& scene) {
  const Parameter normal = scene.pairing ? p_obstaclenormal : p_normal;
  scene.given_normals = args.has(normal);
  for (const BoundaryNode& node : scene.nodes)
    if (!scene.given_normals && length(node.point.normal) == 0)
      throw IllegalInput("the outward normals at " + place(node, scene.d) +
                         " cancel; give normal=[...] explicitly");
  if (!scene.given_normals) return;
  const auto guard = point_guard(stack);
  std::vector<BoundaryNode> facing;
  for (BoundaryNode& node : scene.nodes) {
    node.point.normal = unit_vector(stack, args, normal, node);
    if (node.point.normal.isZero(0))
      refuse(name_of(normal), " has no direction at ", place(node, scene.d),
             "; give the outward normal of the body, of any length > 0");
    if (node.begun) {
      const Vec3 n = unit_vector(stack, args, normal, *node.begun);
      node.begun = std::make_shared<BoundaryNode>(*node.begun);
      node.begun->point.normal = n.isZero(0) ? node.point.normal : n;
    }
    const BoundaryNode& deciding = node.deciding();
    const bool away = faces_away(deciding, deciding.point.normal) || has_opposite(facing, node);
    (away ? scene.averted : facing).push_back(node);
  }
  scene.nodes = std::move(facing);
  merge_equal_normals(scene.nodes);
}

void refuse_inward(const Scene& scene) {
  const BoundaryNode& node = scene.averted.front();
  throw IllegalInput(std::string(scene.pairing ? "obstaclenormal = " : "normal = ") +
                     mortar::place(scene.d, node.point.normal) + " at " + place(node, scene.d) +
                     " points into the body, whose boundary has the outward normal " +
                     mortar::place(scene.d, node.mean) + "; give the normal that leaves the body");
}

std::vector<Vec3> slave_normals(Stack stack, const Arguments& args, const Scene& scene) {
  std::vector<Vec3> normals;
  const auto guard = point_guard(stack);
  for (const BoundaryNode& node : scene.pairing->slave_nodes())
    normals.push_back(unit_vector(stack, args, p_normal, node));
  return normals;
}

void set_orthotropy(Stack stack, const Arguments& args, const Vector& mu, Scene& scene) {
  const Vector mu2 = at_nodes(stack, args, p_mu2, scene.nodes);
  const auto guard = point_guard(stack);
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) {
    BoundaryNode& node = scene.nodes[k];
    if ((mu[k] > 0) != (mu2[k] > 0))
      refuse("mu = ", mu[k], " but mu2 = ", mu2[k], " at ", place(node, scene.d),
             "; both coefficients are > 0, or both are 0");
    if (mu[k] == 0) continue;
    ContactPoint& p = node.point;
    p.direction = unit_vector(stack, args, p_direction, node);
    if (p.direction.isZero(0) || std::abs(dot(p.direction, p.normal)) > 1 - 1e-10)
      throw IllegalInput("direction has no part in the contact plane at " + place(node, scene.d) +
                         "; give a direction, of any length > 0, that is not the normal");
    p.mu_ratio = mu2[k] / mu[k];
  }
}

void refuse_friction_of_none(const char* name, const Arguments& args, const Scene& scene) {
  if (scene.tangents || !args.has_any(frictions)) return;
  refuse(name,
         " was made without friction; name mu, cohesion or slidinglimit in "
         "contactProblem(...), too");
}

PointLaws begun_laws(Stack stack, const Arguments& args, PointLaws given) {
  for (Parameter p : {p_mu, p_cohesion, p_shearmax})
    if (args.has(p) && args.has(p_slidinglimit))
      refuse(name_of(p),
             " and slidinglimit are both given; friction takes mu, cohesion and "
             "shearmax, min(cohesion + mu p, shearmax), a limit without a pressure p "
             "slidinglimit alone");
  if (args.has(p_shearmax) && !args.has_any(frictions) && given.law != Law::coulomb)
    throw IllegalInput(
        "shearmax bounds friction, and there is none; give mu or cohesion with it, or the limit "
        "itself as slidinglimit");
  given.bilateral = args.value(stack, p_bilateral, given.bilateral);
  if (args.has(p_gap) || args.has(p_obstaclegap)) given.gap.resize(0);
  given.given_gap = given.given_gap || args.has(p_gap);
  return given;
}

PointLaws read_laws(Stack stack, const Arguments& args, const Scene& scene, PointLaws laws,
                    const Vector& gap) {
  if (laws.gap.size() != static_cast<Index>(scene.nodes.size()))
    laws.gap = read_gap(stack, args, scene, gap);
  if (args.has(p_slidinglimit)) {
    laws.g = forces_at_nodes(stack, args, p_slidinglimit, scene);
    for (Vector* v : {&laws.mu, &laws.cohesion, &laws.cap}) v->resize(0);
    laws.law = Law::tresca;
  }
  if (args.has(p_mu) || (args.has(p_cohesion) && laws.law != Law::coulomb)) {
    laws.mu = at_nodes(stack, args, p_mu, scene.nodes);
    laws.g.resize(0);
    laws.law = Law::coulomb;
  }
  if (args.has(p_cohesion)) laws.cohesion = forces_at_nodes(stack, args, p_cohesion, scene);
  if (args.has(p_shearmax)) laws.cap = forces_at_nodes(stack, args, p_shearmax, scene);
  return laws;
}

void set_weights(Stack stack, const Arguments& args, Scene& scene) {
  if (!args.has(p_weight)) return;
  const auto guard = point_guard(stack);
  for (BoundaryNode& node : scene.nodes) {
    node.weight = 0;
    for (const AdjacentFacet& facet : node.facets)
      node.weight += weighted_share(stack, args, facet);
  }
}

std::vector<Real> slave_weights(Stack stack, const Arguments& args, const Scene& scene) {
  if (!args.has(p_weight)) return {};
  const Vector w = at_nodes(stack, args, p_weight, scene.pairing->slave_nodes());
  return {w.data(), w.data() + w.size()};
}

int unnamed_radius(const Arguments& args, const Scene& scene, const Triplets& A) {
  if (scene.d == 3 || args.has(p_weight) || scene.nodes.empty()) return -1;
  if (!scene.pairing && !args.has_any(tractions)) return -1;
  const int c = radial_component(A, scene.mesh_node);
  if (c < 0) return -1;
  Real least = 0, most = 0;
  for (const BoundaryNode& n : scene.nodes) {
    const Real r = n.x[c];
    least = std::min(least, r);
    most = std::max(most, r);
  }
  const Real axis = 1e-10 * (most - least);
  return least >= -axis || most <= axis ? c : -1;
}

}  // namespace frictioncg
