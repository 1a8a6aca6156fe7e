#pragma once
#include "freefem.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "../core/assembly/local_system.h"

namespace frictioncg {

/// A contact node as FreeFEM sees it: where to evaluate expressions, and its share of the boundary.
struct BoundaryNode {
  ContactPoint point;
  std::array<double, 3> x{{0, 0, 0}};
  long label = 0;
  double weight = 0;  ///< integral of its shape function over the contact boundary [length^(d-1)]
  int element = 0, facet = 0;
  Fem2D::R3 hat;
};

/// Where a contact node is, for messages.
inline std::string place(const BoundaryNode& node, int dimension) {
  std::ostringstream s;
  s << "(" << node.x[0] << ", " << node.x[1];
  if (dimension == 3) s << ", " << node.x[2];
  s << ") on label " << node.label;
  return s.str();
}

/// What differs between FreeFEM's mesh and mesh3.
template <class FESpaceType>
struct Dimension;

template <>
struct Dimension<Fem2D::FESpace> {
  static constexpr int d = 2;
  using Mesh = Fem2D::Mesh;
  using Element = Fem2D::FElement;
  static long facets(const Mesh& Th) { return Th.neb; }
  static long label(const Mesh& Th, int ib) { return Th.bedges[ib].lab; }
  static bool on_facet(int facet, int what) { return Fem2D::onWhatIsEdge[facet][what] != 0; }
  /// outward, of the length of the edge
  static Fem2D::R3 normal(const Element& K, int facet) {
    const Fem2D::R2 E = K.T.Edge(facet);
    return Fem2D::R3(E.y, -E.x, 0);
  }
  /// integrals of the traces of P1 or P2 over a unit edge
  static double share(std::size_t nodes, bool corner) {
    return nodes == 2 ? 1. / 2 : (corner ? 1. / 6 : 2. / 3);
  }
  static bool is_corner(int what) { return what < 3; }
  static bool known_trace(std::size_t nodes) { return nodes == 2 || nodes == 3; }
  struct Interpolation {
    std::vector<int> dof, component, point;
    std::vector<double> coefficient;
    std::vector<Fem2D::R3> hat;
    explicit Interpolation(const Element& K) {
      const auto& ipj = K.Pi_h_ipj();
      const auto& P = K.Pi_h_R2();
      KN<double> alpha(ipj.N());
      K.Pi_h(alpha);
      for (int k = 0; k < ipj.N(); ++k) {
        dof.push_back(ipj[k].i);
        component.push_back(ipj[k].j);
        point.push_back(ipj[k].p);
        coefficient.push_back(alpha[k]);
      }
      for (int p = 0; p < P.N(); ++p) hat.push_back(Fem2D::R3(P[p].x, P[p].y, 0));
    }
  };
  static Fem2D::R3 position(const Element& K, const Fem2D::R3& hat) {
    const Fem2D::R2 P = K.T(Fem2D::R2(hat.x, hat.y));
    return Fem2D::R3(P.x, P.y, 0);
  }
  static void set_point(MeshPoint* mp, const Fem2D::FESpace& Vh, const BoundaryNode& node) {
    const Mesh& Th = Vh.Th;
    const Fem2D::R2 hat(node.hat.x, node.hat.y);
    mp->set(Th, Th[node.element](hat), hat, Th[node.element], static_cast<int>(node.label),
            Fem2D::R2(node.point.normal[0], node.point.normal[1]), node.facet);
  }
};

template <>
struct Dimension<Fem2D::FESpace3> {
  static constexpr int d = 3;
  using Mesh = Fem2D::Mesh3;
  using Element = Fem2D::FESpace3::FElement;
  static long facets(const Mesh& Th) { return Th.nbe; }
  static long label(const Mesh& Th, int ib) { return Th.be(ib).lab; }
  static bool on_facet(int facet, int what) { return Fem2D::Tet::onWhatBorder[facet][what] != 0; }
  /// outward, of the area of the face
  static Fem2D::R3 normal(const Element& K, int facet) {
    const int(&v)[3] = Fem2D::Tet::nvface[facet];
    const Fem2D::R3 A = K.T[v[0]], B = K.T[v[1]], C = K.T[v[2]], G = K.T(Fem2D::R3(.25, .25, .25));
    Fem2D::R3 N = ((B - A) ^ (C - A)) / 2;
    return (N, A - G) > 0 ? N : -N;
  }
  /// integrals of the traces of P1 or P2 over a unit triangle
  static double share(std::size_t nodes, bool corner) {
    return nodes == 3 ? 1. / 3 : (corner ? 0 : 1. / 3);
  }
  static bool is_corner(int what) { return what < 4; }
  static bool known_trace(std::size_t nodes) { return nodes == 3 || nodes == 6; }
  struct Interpolation {
    std::vector<int> dof, component, point;
    std::vector<double> coefficient;
    std::vector<Fem2D::R3> hat;
    explicit Interpolation(const Element& K) {
      Fem2D::InterpolationMatrix<Fem2D::R3> ip(*K.tfe);
      ip.set(K);
      for (int k = 0; k < ip.ncoef; ++k) {
        dof.push_back(ip.dofe[k]);
        component.push_back(ip.comp[k]);
        point.push_back(ip.p[k]);
        coefficient.push_back(ip.coef[k]);
      }
      for (int p = 0; p < ip.P.N(); ++p) hat.push_back(ip.P[p]);
    }
  };
  static Fem2D::R3 position(const Element& K, const Fem2D::R3& hat) { return K.T(hat); }
  static void set_point(MeshPoint* mp, const Fem2D::FESpace3& Vh, const BoundaryNode& node) {
    const Mesh& Th = Vh.Th;
    mp->set(
        Th, Th[node.element](node.hat), node.hat, Th[node.element], static_cast<int>(node.label),
        Fem2D::R3(node.point.normal[0], node.point.normal[1], node.point.normal[2]), node.facet);
  }
};

[[noreturn]] inline void refuse_space(const std::string& why) {
  throw IllegalInput(
      "Vh " + why +
      "; contact needs a continuous vector Lagrange space such as [P1,P1], [P2,P2] or "
      "[P1,P1,P1]");
}

/// The nodes of one facet: dofs of each component, grouped by the interpolation points they share.
template <class FESpaceType>
std::vector<BoundaryNode> facet_nodes(const typename Dimension<FESpaceType>::Element& K,
                                      int facet) {
  using D = Dimension<FESpaceType>;
  const typename D::Interpolation ip(K);
  std::map<int, int> uses;  // dof -> interpolation points it is made from
  for (int i : ip.dof) ++uses[i];
  std::vector<BoundaryNode> nodes;
  std::vector<bool> corner;
  for (std::size_t k = 0; k < ip.dof.size(); ++k) {
    const int i = ip.dof[k];
    if (!D::on_facet(facet, K.DFOnWhat(i))) continue;
    if (uses[i] != 1 || ip.coefficient[k] != 1)
      refuse_space("has degrees of freedom that are not nodal values");
    const Fem2D::R3 x = D::position(K, ip.hat[ip.point[k]]);
    auto same = std::find_if(nodes.begin(), nodes.end(), [&](const BoundaryNode& n) {
      const double dx = std::abs(n.hat.x - ip.hat[ip.point[k]].x);
      const double dy = std::abs(n.hat.y - ip.hat[ip.point[k]].y);
      const double dz = std::abs(n.hat.z - ip.hat[ip.point[k]].z);
      return dx + dy + dz < 1e-10;
    });
    if (same == nodes.end()) {
      BoundaryNode n;
      n.x = {x.x, x.y, x.z};
      n.hat = ip.hat[ip.point[k]];
      nodes.push_back(n);
      corner.push_back(D::is_corner(K.DFOnWhat(i)));
      same = nodes.end() - 1;
    }
    same->point.dof[ip.component[k]] = K(i);
  }
  if (nodes.empty()) refuse_space("has no degree of freedom on the boundary");
  if (!D::known_trace(nodes.size())) refuse_space("has boundary values that are neither P1 nor P2");
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    nodes[k].weight = D::share(nodes.size(), corner[k]);
    for (int c = 0; c < D::d; ++c)
      if (nodes[k].point.dof[c] < 0)
        refuse_space("mixes elements whose components have different nodes");
  }
  return nodes;
}

/// The contact nodes of the given labels. A node shared by two labels belongs to the one listed
/// first, and takes its normal from there; within a label the normals of its facets are averaged,
/// weighted by their measure.
template <class FESpaceType>
std::vector<BoundaryNode> contact_nodes(const FESpaceType& Vh, const std::vector<long>& labels) {
  using D = Dimension<FESpaceType>;
  if (Vh.N != D::d) {
    std::ostringstream s;
    s << "has " << Vh.N << " component" << (Vh.N > 1 ? "s" : "") << " on a " << D::d << "D mesh";
    refuse_space(s.str());
  }
  const auto& Th = Vh.Th;
  std::map<int, std::size_t> node_of_dof;
  std::vector<BoundaryNode> nodes;
  for (std::size_t l = 0; l < labels.size(); ++l) {
    bool found = false;
    for (int ib = 0; ib < D::facets(Th); ++ib) {
      if (D::label(Th, ib) != labels[l]) continue;
      found = true;
      int facet;
      const int k = Th.BoundaryElement(ib, facet);
      const typename D::Element K(Vh[k]);
      const Fem2D::R3 N = D::normal(K, facet);
      const double measure = Norme2(N);
      for (BoundaryNode& n : facet_nodes<FESpaceType>(K, facet)) {
        const auto [entry, is_new] = node_of_dof.emplace(n.point.dof[0], nodes.size());
        if (is_new) {
          n.label = labels[l];
          n.element = k;
          n.facet = facet;
          nodes.push_back(n);
          nodes.back().weight = 0;
        }
        BoundaryNode& node = nodes[entry->second];
        node.weight += measure * n.weight;
        if (node.label != labels[l]) continue;
        node.point.normal[0] += N.x;
        node.point.normal[1] += N.y;
        node.point.normal[2] += N.z;
      }
    }
    if (!found) {
      std::set<long> present;
      for (int ib = 0; ib < D::facets(Th); ++ib) present.insert(D::label(Th, ib));
      std::ostringstream s;
      s << "label " << labels[l] << " is not on the boundary of the mesh, which has the labels";
      for (long p : present) s << " " << p;
      throw IllegalInput(s.str());
    }
  }
  for (BoundaryNode& n : nodes) {
    const double norm =
        std::hypot(std::hypot(n.point.normal[0], n.point.normal[1]), n.point.normal[2]);
    if (norm == 0)
      throw IllegalInput("the outward normals at " + place(n, D::d) +
                         " cancel; give normal=[...] explicitly");
    for (double& c : n.point.normal) c /= norm;
  }
  return nodes;
}

}  // namespace frictioncg
