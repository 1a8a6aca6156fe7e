#include "freefem.h"

#include "space.h"

#include "../core/assembly/mortar/surface.h"

namespace frictioncg {

namespace {

Vec3 as_vector(const R3& x) { return Vec3(x.x, x.y, x.z); }
R3 as_R3(const Vec3& x) { return R3(x[0], x[1], x[2]); }

/// How the dofs of an element come from values at points: one entry per dof and point that has a
/// part in it. A dof is a nodal value where it has one entry, of coefficient 1.
struct Interpolation {
  struct Entry {
    int dof, component, point;
    double coefficient;
  };
  std::vector<Entry> entries;
  std::vector<Vec3> hat;  ///< the points, on the reference element
  void clear() {
    entries.clear();
    hat.clear();
  }
  void add(int i, int c, int p, double a) {
    // P3 and beyond list every order of an edge's points, all but one by 0
    if (a != 0) entries.push_back({i, c, p, a});
  }
};

/// The vertices of an element, 3 in 2D.
using Vertices = std::array<Vec3, 4>;

/// What differs between FreeFEM's mesh and mesh3, and their finite-element spaces.
template <class FESpaceType>
struct Dimension;

template <>
struct Dimension<Fem2D::FESpace> {
  static constexpr int d = 2;
  using Mesh = Fem2D::Mesh;
  using Element = Fem2D::FElement;
  static constexpr const char* facet_name = "edge";
  static bool on_facet(int facet, int what) { return Fem2D::onWhatIsEdge[facet][what] != 0; }
  /// outward, of the length of the edge; x: the vertices of an element
  static Vec3 normal(const Vertices& x, int facet) {
    const Vec3 E = x[(facet + 2) % 3] - x[(facet + 1) % 3];
    return Vec3(E[1], -E[0], 0);
  }
  /// twice the area, > 0 where the vertices run counter-clockwise
  static double content(const Vertices& x) { return (x[1] - x[0]).cross(x[2] - x[0])[2]; }
  /// integrals of the traces of P1 or P2 over a unit edge
  static double share(std::size_t nodes, bool corner) {
    return nodes == 2 ? 1. / 2 : (corner ? 1. / 6 : 2. / 3);
  }
  /// integrals of the functions of P1 or P2 over an element, up to a factor
  static double integral(bool quadratic, bool corner) { return quadratic && corner ? 0 : 1; }
  /// The mean, by a trace, of what is linear: so much of it is the value at the trace's node, the
  /// rest the mean over the edge.
  static double own(std::size_t nodes) { return nodes == 2 ? 1. / 3 : 1; }
  /// Into ip, whose storage serves one element after the other.
  static void interpolate(const Element& K, Interpolation& ip) {
    ip.clear();
    const auto& ipj = K.Pi_h_ipj();
    const auto& P = K.Pi_h_R2();
    KN<double> alpha(ipj.N());
    K.Pi_h(alpha);
    for (int k = 0; k < ipj.N(); ++k) ip.add(ipj[k].i, ipj[k].j, ipj[k].p, alpha[k]);
    for (int p = 0; p < P.N(); ++p) ip.hat.emplace_back(P[p].x, P[p].y, 0);
  }
  static Vec3 position(const Mesh& Th, int k, const Vec3& hat) {
    const Fem2D::R2 P = Th[k](Fem2D::R2(hat[0], hat[1]));
    return Vec3(P.x, P.y, 0);
  }
  static void set_point(MeshPoint* mp, const Mesh& Th, const BoundaryNode& node, const Vec3& x) {
    mp->set(Th, Fem2D::R2(x[0], x[1]), Fem2D::R2(node.hat[0], node.hat[1]), Th[node.element],
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
  static bool on_facet(int facet, int what) { return Fem2D::Tet::onWhatBorder[facet][what] != 0; }
  /// outward, of the area of the face
  static Vec3 normal(const Vertices& x, int facet) {
    const int(&v)[3] = Fem2D::Tet::nvface[facet];
    const Vec3 N = (x[v[1]] - x[v[0]]).cross(x[v[2]] - x[v[0]]) / 2;
    return dot(N, x[v[0]] - x[facet]) > 0 ? N : -N;
  }
  /// six times the volume, with the sign of the element's orientation
  static double content(const Vertices& x) {
    return dot((x[1] - x[0]).cross(x[2] - x[0]), x[3] - x[0]);
  }
  /// integrals of the traces of P1 or P2 over a unit triangle
  static double share(std::size_t nodes, bool corner) {
    return nodes == 3 ? 1. / 3 : (corner ? 0 : 1. / 3);
  }
  static double integral(bool quadratic, bool corner) { return !quadratic ? 1 : corner ? -1 : 4; }
  static double own(std::size_t nodes) { return nodes == 3 ? 1. / 4 : 2. / 5; }
  static void interpolate(const Element& K, Interpolation& ip) {
    ip.clear();
    Fem2D::InterpolationMatrix<R3> all(*K.tfe);
    all.set(K);
    for (int k = 0; k < all.ncoef; ++k) ip.add(all.dofe[k], all.comp[k], all.p[k], all.coef[k]);
    for (int p = 0; p < all.P.N(); ++p) ip.hat.push_back(as_vector(all.P[p]));
  }
  static Vec3 position(const Mesh& Th, int k, const Vec3& hat) {
    return as_vector(Th[k](as_R3(hat)));
  }
  static void set_point(MeshPoint* mp, const Mesh& Th, const BoundaryNode& node, const Vec3& x) {
    mp->set(Th, as_R3(x), as_R3(node.hat), Th[node.element], static_cast<int>(node.label),
            as_R3(node.point.normal), node.facet);
  }
};

/// A node of one facet: the dof of each component, by the interpolation point that they share.
struct FacetNode {
  Vec3 hat;
  std::array<Index, 3> dof{{-1, -1, -1}};
  Vec3 x = Vec3::Zero();
  bool corner = false;
};

/// The nodes of a facet in the order of BoundaryFacet::node.
std::vector<std::size_t> in_order(const std::vector<FacetNode>& node, int d) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < node.size(); ++k)
    if (node[k].corner) order.push_back(k);
  if (node.size() == order.size()) return order;
  for (int edge = 0; edge < mortar::edges_of_facet(d); ++edge) {
    const auto [a, b] = mortar::edge_ends(d, edge);
    const Vec3 ends = node[order[a]].hat + node[order[b]].hat;
    for (std::size_t k = 0; k < node.size(); ++k)
      if (length(2 * node[k].hat - ends) < 1e-10) order.push_back(k);
  }
  return order;
}

template <class FESpaceType>
class SpaceOn final : public Space {
  using D = Dimension<FESpaceType>;
  using Mesh = typename D::Mesh;
  using Element = typename D::Element;

 public:
  SpaceOn(const FESpaceType& Vh, const char* word, Index first, const Stage& where = {})
      : Space(D::d, word, first, where), keep_(const_cast<FESpaceType*>(&Vh)) {
    if (is_moved()) move_vertices();
  }
  SpacePtr at(const Stage& other) const override {
    return std::make_shared<const SpaceOn>(space(), name, offset, other);
  }
  Index dofs() const override { return space().NbOfDF; }
  Index vertices() const override { return mesh().nv; }
  Index elements() const override { return mesh().nt; }
  std::array<Index, 4> element(Index k) const override {
    std::array<Index, 4> vertex{{-1, -1, -1, -1}};
    for (int v = 0; v <= D::d; ++v) vertex[v] = mesh()(k, v);
    return vertex;
  }
  std::set<long> labels() const override {
    std::set<long> labels;
    for (int ib = 0; ib < mesh().nbBrdElmts(); ++ib) labels.insert(mesh().be(ib).lab);
    return labels;
  }
  Boundary boundary(const std::vector<long>& labels, const char* inside) const override {
    if (space().N != D::d)
      refuse_space("has " + std::to_string(space().N) + " component" + (space().N > 1 ? "s" : "") +
                   " on a " + std::to_string(D::d) + "D mesh");
    std::map<long, std::vector<int>> facets;  // of each label, named once
    for (long label : labels) facets[label];
    for (int ib = 0; ib < mesh().nbBrdElmts(); ++ib)
      if (const auto of = facets.find(mesh().be(ib).lab); of != facets.end())
        of->second.push_back(ib);
    Boundary found;
    found.is_moved = is_moved();
    std::map<Index, std::size_t> node_of_dof;  // first dof of a node -> its place in the boundary
    for (long label : labels) {
      const auto of = facets.find(label);
      if (of == facets.end()) continue;
      if (of->second.empty()) refuse_absent(label);
      for (int ib : of->second) {
        int facet;
        const int k = mesh().BoundaryElement(ib, facet);
        add_facet({this, label, k, facet}, inside, node_of_dof, found);
      }
      facets.erase(of);
    }
    return found;
  }
  SharedNode node_at_vertex(Index element, int vertex) const override {
    const Element K(space()[element]);
    Interpolation ip;
    D::interpolate(K, ip);
    SharedNode node;
    for (const auto& e : ip.entries) {
      const Vec3& hat = ip.hat[e.point];
      if (corner_at(hat, D::d) != vertex || e.coefficient != 1) continue;
      node.dof[e.component] = dof(K, e.dof);
      node.x = place(element, hat);
    }
    node.moved = moved(node.dof);
    return node;
  }
  double thickness(Index element, int facet) const override {
    constexpr double thick = 4;  // deeper overlaps are none, whatever is there
    constexpr int n = D::d + 1;
    using Square = Eigen::Matrix<double, n, n>;
    using Point = Eigen::Matrix<double, n, 1>;
    const auto vertices = [&](Index k) {  // columns (x, 1)
      Square V;
      for (int v = 0; v < n; ++v)
        V.col(v) << D::position(mesh(), k, corner(v)).template head<D::d>(), 1;
      return V;
    };
    const Square first = vertices(element);
    Square lambda = first.inverse();  // barycentric coordinates of (x, 1), by rows
    const Point middle = (first.rowwise().sum() - first.col(facet)) / D::d;
    Point inward = Point::Zero();
    inward.template head<D::d>() = lambda.row(facet).template head<D::d>().normalized();
    const double most = thick * 2 * (first.col((facet + 1) % n) - middle).norm();
    double depth = 0;
    for (int from = facet; depth < most;) {
      const Point here = lambda * (middle + depth * inward), rate = lambda * inward;
      int out = -1;
      double step = infinity;
      for (int v = 0; v < n; ++v)
        if (v != from && rate[v] < 0 && -here[v] / rate[v] < step)
          out = v, step = -here[v] / rate[v];
      if (out < 0) return infinity;
      depth += std::max(0., step);
      from = out;
      const Index behind = mesh().ElementAdj(element, from);
      if (is_none(behind, element)) return depth;
      element = behind;
      lambda = vertices(element).inverse();
    }
    return depth;
  }
  void add_mesh_nodes(std::vector<Index>& node) const override {
    const Index first = node.empty() ? 0 : *std::max_element(node.begin(), node.end()) + 1;
    node.resize(offset + dofs());
    for (int k = 0; k < space().NbOfNodes; ++k)
      for (int i = space().FirstDFOfNode(k); i < space().LastDFOfNode(k); ++i)
        node[offset + i] = first + k;
  }
  /// Elements with nothing new are passed over: most of them, in 3D.
  void add_places(std::vector<NodePlace>& places) const override {
    const Index first = count_bodies(places);
    const std::vector<Index> body = body_of_element();
    std::vector<NodePlace> at_point;
    std::vector<char> seen(offset + dofs(), 0);
    const auto is_new = [&](Index i) { return !seen[i]; };
    for_each_element(is_new, [&](int k, const Element& K, const Interpolation& ip) {
      at_point.assign(ip.hat.size(), NodePlace());
      for (const auto& e : ip.entries)
        if (e.coefficient == 1) at_point[e.point].dof[e.component] = dof(K, e.dof);
      for (std::size_t p = 0; p < at_point.size(); ++p) {
        NodePlace& n = at_point[p];
        if (std::count(n.dof.begin(), n.dof.begin() + D::d, -1) > 0 || seen[n.dof[0]]) continue;
        n.x = node(k, ip.hat[p], n.dof);
        n.body = first + body[k];
        places.push_back(n);
        seen[n.dof[0]] = 1;
      }
      for (int i = 0; i < K.NbDoF(); ++i) seen[dof(K, i)] = 1;
    });
  }
  void add_labelled(std::vector<LabelledNode>& all) const override {
    for (int ib = 0; ib < mesh().nbBrdElmts(); ++ib) {
      int facet;
      const int k = mesh().BoundaryElement(ib, facet);
      const Real measure = length(D::normal(vertices_of(k), facet));
      const std::vector<FacetNode> nodes = facet_nodes(k, facet);
      for (const FacetNode& n : nodes)
        all.push_back({mesh().be(ib).lab, n.dof, measure * D::share(nodes.size(), n.corner),
                       offset > 0 ? 1 : 0});
    }
  }
  void add_unit_load(const Dirichlet& of, Vector& load) const override {
    const auto is_wanted = [&](Index i) { return of.holds(i); };
    for_each_element(is_wanted, [&](int k, const Element& K, const Interpolation& ip) {
      const auto at_corner = [&](int p) { return corner_at(ip.hat[p], D::d) >= 0; };
      const bool quadratic = std::any_of(ip.hat.begin(), ip.hat.end(), [](const Vec3& hat) {
        return hat.sum() == 0.5;  // in the middle of an edge, which no bubble is
      });
      const Real content = std::abs(D::content(vertices_of(k)));
      for (const auto& e : ip.entries)
        load[dof(K, e.dof)] += content * D::integral(quadratic, at_corner(e.point));
    });
  }
  Vec3 go_to(Stack stack, const BoundaryNode& node) const override {
    const Vec3 x = place(node.element, node.hat) + node.aside;
    D::set_point(MeshPointStack(stack), mesh(), node, x);
    return x;
  }

 private:
  const FESpaceType& space() const { return *keep_; }
  const Mesh& mesh() const { return space().Th; }
  /// The number of dof i of an element.
  Index dof(const Element& K, int i) const { return offset + K(i); }
  static Vec3 corner(int v) { return Vec3(v == 1, v == 2, v == 3); }
  /// Whether there is no element behind a facet of k: on a mesh k is its own neighbour there.
  static bool is_none(Index neighbour, Index k) { return neighbour < 0 || neighbour == k; }
  /// A point of element k, by its place in the reference element.
  Vec3 place(int k, const Vec3& hat) const {
    Vec3 x = D::position(mesh(), k, hat);
    if (!is_moved()) return x;
    const double lambda[4] = {1 - hat[0] - hat[1] - hat[2], hat[0], hat[1], hat[2]};
    for (int v = 0; v <= D::d; ++v) x += lambda[v] * of_vertex_[mesh()(k, v)];
    return x;
  }
  Vertices vertices_of(int k) const {
    Vertices x;
    for (int v = 0; v <= D::d; ++v) x[v] = place(k, corner(v));
    return x;
  }
  /// The displacement of the node that has these dofs.
  Vec3 moved(const std::array<Index, 3>& of_node) const {
    Vec3 u = Vec3::Zero();
    for (int c = 0; c < D::d && is_moved(); ++c) u[c] = (*stage.at)[of_node[c]];
    return u;
  }
  /// A node of element k itself: that of a P2 edge may have left the edge's middle.
  Vec3 node(int k, const Vec3& hat, const std::array<Index, 3>& of_node) const {
    return D::position(mesh(), k, hat) + moved(of_node);
  }
  /// Whether the displacement turns element k inside out, or flattens it.
  bool is_inverted(int k) const {
    constexpr double flat = 1e-9;
    if (!is_moved()) return false;
    Vertices X;
    for (int v = 0; v <= D::d; ++v) X[v] = D::position(mesh(), k, corner(v));
    return !(D::content(vertices_of(k)) > flat * D::content(X));
  }
  /// visit(k, element, interpolation), where a dof of the element is wanted.
  template <class Wanted, class Visit>
  void for_each_element(const Wanted& wanted, const Visit& visit) const {
    Interpolation ip;
    for (int k = 0; k < elements(); ++k) {
      const Element K(space()[k]);
      bool any = false;
      for (int i = 0; i < K.NbDoF() && !any; ++i) any = wanted(dof(K, i));
      if (!any) continue;
      D::interpolate(K, ip);
      visit(k, K, ip);
    }
  }
  /// Elements with no new vertex are passed over.
  void move_vertices() {
    of_vertex_.assign(mesh().nv, Vec3::Zero());
    std::vector<char> known(mesh().nv, 0);
    Interpolation ip;
    for (int k = 0; k < mesh().nt; ++k) {
      bool news = false;
      for (int v = 0; v <= D::d; ++v) news = news || !known[mesh()(k, v)];
      if (!news) continue;
      const Element K(space()[k]);
      D::interpolate(K, ip);
      for (const auto& e : ip.entries) {
        const int v = corner_at(ip.hat[e.point], D::d);
        if (v < 0 || e.component >= D::d || e.coefficient != 1) continue;
        of_vertex_[mesh()(k, v)][e.component] = (*stage.at)[dof(K, e.dof)];
        known[mesh()(k, v)] = 1;
      }
    }
  }
  /// Refuses traces for which the laws are not written.
  std::vector<FacetNode> facet_nodes(int k, int facet) const {
    const Element K(space()[k]);
    Interpolation ip;
    D::interpolate(K, ip);
    std::map<int, int> uses;  // dof -> interpolation points it is made from
    for (const auto& e : ip.entries) ++uses[e.dof];
    std::vector<FacetNode> found;
    for (const auto& e : ip.entries) {
      const int what = K.DFOnWhat(e.dof);
      if (!D::on_facet(facet, what)) continue;
      if (uses[e.dof] != 1 || e.coefficient != 1)
        refuse_space("has degrees of freedom that are not nodal values");
      const Vec3& hat = ip.hat[e.point];
      const auto is_here = [&](const FacetNode& n) {
        return (n.hat - hat).template lpNorm<1>() < 1e-10;
      };
      auto n = std::find_if(found.begin(), found.end(), is_here);
      if (n == found.end())
        n = found.insert(n, FacetNode{hat, {{-1, -1, -1}}, place(k, hat), what <= D::d});
      n->dof[e.component] = dof(K, e.dof);
    }
    if (found.empty()) refuse_space("has no degree of freedom on the boundary");
    for (const FacetNode& n : found)
      if (std::count(n.dof.begin(), n.dof.begin() + D::d, -1) > 0)
        refuse_space("mixes elements whose components have different nodes");
    const std::size_t of_P1 = D::d, of_P2 = mortar::nodes_of_facet(D::d, true);
    if (found.size() != of_P1 && found.size() != of_P2)
      refuse_space("has " + std::to_string(found.size()) + " nodes on each boundary " +
                   D::facet_name + ", where the laws of contact are written for the " +
                   std::to_string(of_P1) + " of P1 and the " + std::to_string(of_P2) + " of P2");
    return found;
  }
  void add_facet(const FacetPoint& at, const char* inside,
                 std::map<Index, std::size_t>& node_of_dof, Boundary& all) const {
    const Vec3 normal = D::normal(vertices_of(at.element), at.facet);
    const std::vector<FacetNode> nodes = facet_nodes(at.element, at.facet);
    int facet = at.facet;
    if (!is_none(mesh().ElementAdj(at.element, facet), at.element))
      refuse("label ", at.label, " lies inside the body at ", mortar::place(D::d, nodes.front().x),
             ", with elements on both sides of its ", D::facet_name, "s; ", inside);
    if (is_inverted(at.element)) refuse_inverted(at, nodes);
    std::vector<std::size_t> number;
    for (const FacetNode& n : nodes) {
      const auto [entry, is_new] = node_of_dof.emplace(n.dof[0], all.nodes.size());
      number.push_back(entry->second);
      if (is_new) {
        const Vec3 aside =
            is_moved() ? Vec3(node(at.element, n.hat, n.dof) - n.x) : Vec3(Vec3::Zero());
        all.nodes.push_back({n.dof, n.x, moved(n.dof), aside, {}, {}});
      }
      SharedNode& shared = all.nodes[entry->second];
      if (is_elsewhere(n.x, shared.x, normal, D::d)) shared.other = n.x;
      const double share = length(normal) * D::share(nodes.size(), n.corner);
      AdjacentFacet seen{at, normal, share, all.facets.size(), D::own(nodes.size()), normal};
      seen.hat = n.hat;
      shared.facets.push_back(seen);
    }
    all.facets.push_back({at.label, normal, {}, at.element, at.facet});
    for (std::size_t n : in_order(nodes, D::d)) all.facets.back().node.push_back(number[n]);
  }
  [[noreturn]] void refuse_space(const std::string& why) const {
    refuse(name, " ", why, "; contact needs a continuous vector Lagrange space such as ",
           D::d == 2 ? "[P1,P1] or [P2,P2]" : "[P1,P1,P1] or [P2,P2,P2]");
  }
  [[noreturn]] void refuse_absent(long label) const {
    std::string present;
    for (long other : labels()) present += " " + std::to_string(other);
    refuse("label ", label, " is not on the boundary of ", mesh_in_words(),
           ", which has the labels", present);
  }
  /// By the middle of the facet, on the mesh.
  [[noreturn]] void refuse_inverted(const FacetPoint& at,
                                    const std::vector<FacetNode>& facet) const {
    Vec3 middle = Vec3::Zero();
    for (const FacetNode& n : facet)
      if (n.corner) middle += D::position(mesh(), at.element, n.hat) / D::d;
    refuse(stage.name, " turns the element behind the ", D::facet_name, " at ",
           mortar::place(D::d, middle), " on label ", at.label,
           " inside out, or makes it flat; take a smaller increment of the load, or a "
           "part of the step");
  }

  CountPointer<FESpaceType> keep_;
  std::vector<Vec3> of_vertex_;  ///< displacements; empty: none
};

template <class V>
SpacePtr space_of(Stack stack, Expression e, const char* name, Index offset) {
  const typename V::FESpace* Vh = evaluated(name, [&] {
    typename V::pfes* p = GetAny<typename V::pfes*>((*e)(stack));
    return p && *p ? static_cast<typename V::FESpace*>(**p) : nullptr;
  });
  if (!Vh) refuse(name, " is not a finite-element space");
  return std::make_shared<const SpaceOn<typename V::FESpace>>(*Vh, name, offset);
}

}  // namespace

SpacePtr space_of(Stack stack, int d, Expression e, const char* name, Index offset) {
  return d == 2 ? space_of<v_fes>(stack, e, name, offset)
                : space_of<v_fes3>(stack, e, name, offset);
}

Spaces at(const Stage& stage, const Spaces& spaces) {
  Spaces there;
  for (const SpacePtr& space : spaces) there.push_back(space->at(stage));
  return there;
}

const Space* Space::begun() const {
  if (!begun_ && is_moved() && stage.begun) begun_ = at({stage.begun, nullptr, "uold"});
  return begun_.get();
}

std::string Space::mesh_in_words() const {
  return std::string("the mesh") + (name == std::string("Vh") ? "" : std::string(" of ") + name);
}

std::vector<Index> Space::body_of_element() const {
  Groups groups(vertices());
  for (Index k = 0; k < elements(); ++k) {
    const std::array<Index, 4> vertex = element(k);
    for (int v = 1; v <= d; ++v) groups.join(vertex[0], vertex[v]);
  }
  std::map<Index, Index> number;
  std::vector<Index> body(elements());
  for (Index k = 0; k < elements(); ++k)
    body[k] = number.try_emplace(groups.of(element(k)[0]), static_cast<Index>(number.size()))
                  .first->second;
  return body;
}

std::vector<Index> body_of_dofs(const std::vector<NodePlace>& nodes, int d, Index n) {
  std::vector<Index> body(n, -1);
  for (const NodePlace& p : nodes)
    for (int c = 0; c < d; ++c) body[p.dof[c]] = p.body;
  return body;
}

std::vector<Index> body_of_nodes(const NodeDofs& some, const std::vector<NodePlace>& all, int d,
                                 Index n) {
  const std::vector<Index> of_dof = body_of_dofs(all, d, n);
  std::vector<Index> body;
  for (const auto& dof : some) body.push_back(of_dof[dof[0]]);
  return body;
}

int corner_at(const Vec3& hat, int d) {
  const double lambda[4] = {1 - hat[0] - hat[1] - hat[2], hat[0], hat[1], hat[2]};
  for (int v = 0; v <= d; ++v)
    if (std::abs(lambda[v] - 1) < 1e-10) return v;
  return -1;
}

std::shared_ptr<const void> point_guard(Stack stack) {
  const MeshPoint saved = *MeshPointStack(stack);
  return {nullptr, [stack, saved](const void*) { *MeshPointStack(stack) = saved; }};
}

}  // namespace frictioncg
