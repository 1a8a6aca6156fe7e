#pragma once
#include "freefem.h"

namespace frictioncg {

/// What differs between FreeFEM's mesh and mesh3, and their finite-element spaces.
template <class FESpaceType>
struct Dimension;

/// How the dofs of an element come from values at points: one entry per dof and point that has a
/// part in it. A dof is a nodal value where it has one entry, of coefficient 1.
struct Interpolation {
  std::vector<int> dof, component, point;
  std::vector<double> coefficient;
  std::vector<Fem2D::R3> hat;  ///< the points, on the reference element

  void clear() {
    dof.clear();
    component.clear();
    point.clear();
    coefficient.clear();
    hat.clear();
  }
  void add(int i, int c, int p, double a) {
    if (a == 0) return;  // P3 and beyond list every order of an edge's points, all but one by 0
    dof.push_back(i);
    component.push_back(c);
    point.push_back(p);
    coefficient.push_back(a);
  }
};

/// The vertices of an element, 3 in 2D.
using Vertices = std::array<Fem2D::R3, 4>;

/// The vertex at a place of the reference simplex, or -1.
inline int corner_at(const Fem2D::R3& hat, int d) {
  const double lambda[4] = {1 - hat.x - hat.y - hat.z, hat.x, hat.y, hat.z};
  for (int v = 0; v <= d; ++v)
    if (std::abs(lambda[v] - 1) < 1e-10) return v;
  return -1;
}

template <>
struct Dimension<Fem2D::FESpace> {
  static constexpr int d = 2;
  using Mesh = Fem2D::Mesh;
  using Element = Fem2D::FElement;
  static constexpr const char* facet_name = "edge";

  static long facets(const Mesh& Th) { return Th.neb; }
  static long label(const Mesh& Th, int ib) { return Th.bedges[ib].lab; }
  /// False where there are elements on both sides.
  static bool outer(const Mesh& Th, int k, int facet) { return Th.nTonEdge(k, facet) == 1; }
  static bool on_facet(int facet, int what) { return Fem2D::onWhatIsEdge[facet][what] != 0; }
  /// outward, of the length of the edge; x: the vertices of an element
  static Fem2D::R3 normal(const Vertices& x, int facet) {
    const Fem2D::R3 E = x[(facet + 2) % 3] - x[(facet + 1) % 3];
    return Fem2D::R3(E.y, -E.x, 0);
  }
  /// twice the area, > 0 where the vertices run counter-clockwise
  static double content(const Vertices& x) { return ((x[1] - x[0]) ^ (x[2] - x[0])).z; }
  static bool is_corner(int what) { return what < 3; }
  static bool known_trace(std::size_t nodes) { return nodes == 2 || nodes == 3; }
  /// integrals of the traces of P1 or P2 over a unit edge
  static double share(std::size_t nodes, bool corner) {
    return nodes == 2 ? 1. / 2 : (corner ? 1. / 6 : 2. / 3);
  }
  /// The mean, by a trace, of what is linear: so much of it is the value at the trace's node, the
  /// rest the mean over the edge.
  static double own(std::size_t nodes) { return nodes == 2 ? 1. / 3 : 1; }
  static constexpr const char* known_counts = "the 2 of P1 and the 3 of P2";

  /// Into ip, whose storage serves one element after the other.
  static void interpolate(const Element& K, Interpolation& ip) {
    ip.clear();
    const auto& ipj = K.Pi_h_ipj();
    const auto& P = K.Pi_h_R2();
    KN<double> alpha(ipj.N());
    K.Pi_h(alpha);
    for (int k = 0; k < ipj.N(); ++k) ip.add(ipj[k].i, ipj[k].j, ipj[k].p, alpha[k]);
    for (int p = 0; p < P.N(); ++p) ip.hat.push_back(Fem2D::R3(P[p].x, P[p].y, 0));
  }
  static Fem2D::R3 position(const Mesh& Th, int k, const Fem2D::R3& hat) {
    const Fem2D::R2 P = Th[k](Fem2D::R2(hat.x, hat.y));
    return Fem2D::R3(P.x, P.y, 0);
  }
  template <class Node>
  static void set_point(MeshPoint* mp, const Mesh& Th, const Node& node, const Fem2D::R3& x) {
    mp->set(Th, Fem2D::R2(x.x, x.y), Fem2D::R2(node.hat.x, node.hat.y), Th[node.element],
            static_cast<int>(node.label), Fem2D::R2(node.point.normal[0], node.point.normal[1]),
            node.facet);
  }
};

template <>
struct Dimension<Fem2D::FESpace3> {
  static constexpr int d = 3;
  using Mesh = Fem2D::Mesh3;
  using Element = Fem2D::FESpace3::FElement;
  static constexpr const char* facet_name = "face";

  static long facets(const Mesh& Th) { return Th.nbe; }
  static long label(const Mesh& Th, int ib) { return Th.be(ib).lab; }
  static bool outer(const Mesh& Th, int k, int facet) { return Th.ElementAdj(k, facet) < 0; }
  static bool on_facet(int facet, int what) { return Fem2D::Tet::onWhatBorder[facet][what] != 0; }
  /// outward, of the area of the face
  static Fem2D::R3 normal(const Vertices& x, int facet) {
    const int(&v)[3] = Fem2D::Tet::nvface[facet];
    const Fem2D::R3 N = ((x[v[1]] - x[v[0]]) ^ (x[v[2]] - x[v[0]])) / 2;
    return (N, x[v[0]] - x[facet]) > 0 ? N : -N;
  }
  /// six times the volume, with the sign of the element's orientation
  static double content(const Vertices& x) { return ((x[1] - x[0]) ^ (x[2] - x[0]), x[3] - x[0]); }
  static bool is_corner(int what) { return what < 4; }
  static bool known_trace(std::size_t nodes) { return nodes == 3 || nodes == 6; }
  /// integrals of the traces of P1 or P2 over a unit triangle
  static double share(std::size_t nodes, bool corner) {
    return nodes == 3 ? 1. / 3 : (corner ? 0 : 1. / 3);
  }
  static double own(std::size_t nodes) { return nodes == 3 ? 1. / 4 : 2. / 5; }
  static constexpr const char* known_counts = "the 3 of P1 and the 6 of P2";

  static void interpolate(const Element& K, Interpolation& ip) {
    ip.clear();
    Fem2D::InterpolationMatrix<Fem2D::R3> all(*K.tfe);
    all.set(K);
    for (int k = 0; k < all.ncoef; ++k) ip.add(all.dofe[k], all.comp[k], all.p[k], all.coef[k]);
    for (int p = 0; p < all.P.N(); ++p) ip.hat.push_back(all.P[p]);
  }
  static Fem2D::R3 position(const Mesh& Th, int k, const Fem2D::R3& hat) { return Th[k](hat); }
  template <class Node>
  static void set_point(MeshPoint* mp, const Mesh& Th, const Node& node, const Fem2D::R3& x) {
    mp->set(Th, x, node.hat, Th[node.element], static_cast<int>(node.label),
            Fem2D::R3(node.point.normal[0], node.point.normal[1], node.point.normal[2]),
            node.facet);
  }
};

}  // namespace frictioncg
