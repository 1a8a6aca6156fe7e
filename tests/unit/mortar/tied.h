#pragma once
// The tied problem in w, solved by a sparse factorization.
#include "bodies.h"

namespace frictioncg::mortar::test {

/// A body pair to be tied, or joined along its normals only.
struct Scene {
  MeshedBodies bodies;
  std::vector<Pair> pairs;
  std::vector<unsigned char> held;  ///< per node, bit per component
  Vector data, load;                ///< d nodes: displacement where held; forces
  Options options;

  explicit Scene(int d = 2, bool quadratic = false) {
    bodies.d = d;
    bodies.quadratic = quadratic;
  }
  int d() const { return bodies.d; }
  void start() {
    held.assign(bodies.X.size(), 0);
    data = load = Vector::Zero(d() * bodies.nodes());
  }
  void hold(Index node, int component, Real value) {
    held[node] |= static_cast<unsigned char>(1 << component);
    data[d() * node + component] = value;
  }
  Nodes nodes() const { return {d(), bodies.X, held}; }
  Mortar mortar() const { return Mortar(nodes(), pairs, options); }
};

struct Tied {
  Vector u, residual;  ///< residual: Au - F, forces of the other body and of supports
};

/// T of all components, with rows of the identity at held dofs.
Matrix change_of_basis(const Scene& s, const Mortar& mortar);

/// w = 0 at contact nodes; with normal_only, w.n = 0 there, by a stiff frame: n along an axis.
Tied solve_tied(const Scene& s, const Mortar& mortar, bool normal_only = false);

/// Holds every node that `where` accepts at u = H x.
void hold_linear(Scene& s, const Eigen::Matrix3d& H, const std::function<bool(const Vec3&)>& where);

/// max |u - H x| over max |H x|
Real error_of(const Scene& s, const Vector& u, const Eigen::Matrix3d& H);

/// A gradient without symmetry; 2D: in the plane.
Eigen::Matrix3d some_gradient(int d);

/// Keeps the faces of the unit box in their planes and moves what is between, by `a`; turns the
/// mesh about the vertical axis of the box by up to `turn`.
Vec3 distorted(int d, const Vec3& x, Real a, Real phase, Real turn = 0);

/// Two unit boxes on one another, with meshes that do not match: the lower one is first.
Scene stacked(
    int d, bool quadratic, int lower, int upper, Real a = 0.3, Real turn = 0,
    const Map& place = [](const Vec3& x) { return x; }, Real ratio = 1);

}  // namespace frictioncg::mortar::test
