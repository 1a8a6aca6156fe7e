#include "freefem.h"

#include "space.h"

#include "../core/assembly/mortar/surface.h"
#include "../core/assembly/mortar/topology.h"

namespace frictioncg {

namespace {

Vec3 as_vector(const R3& x) { return Vec3(x.x, x.y, x.z); }
R3 as_R3(const Vec3& x) { return R3(x[0], x[1], x[2]); }

/// What differs between FreeFEM's mesh and mesh3, and their finite-element spaces.
template <class FESpaceType>
struct Dimension;

/// How the dofs of an element come from values at points: one entry per dof and point that has a
/// part in it. A dof is a nodal value where it has one entry, of coefficient 1.
struct Interpolation {
  struct Entry {
    int dof, component, point;
    double coefficient;
  };
  std::vector<Entry> entries;
  std::vector<R3> hat;  ///< the points, on the reference element
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
using Vertices = std::array<R3, 4>;

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
  static R3 normal(const Vertices& x, int facet) {
    const R3 E = x[(facet + 2) % 3] - x[(facet + 1) % 3];
    return R3(E.y, -E.x, 0);
  }
  /// twice the area, > 0 where the vertices run counter-clockwise
  static double content(const Vertices& x) { return ((x[1] - x[0]) ^ (x[2] - x[0])).z; }
  static bool is_corner(int what) { return what < 3; }
  static bool known_trace(std::size_t nodes) { return nodes == 2 || nodes == 3; }
  /// integrals of the traces of P1 or P2 over a unit edge
  static double share(std::size_t nodes, bool corner) {
    return nodes == 2 ? 1. / 2 : (corner ? 1. / 6 : 2. / 3);
  }
  /// integrals of the functions of P1 or P2 over an element, up to a factor
  static double integral(bool quadratic, bool corner) { return quadratic && corner ? 0 : 1; }
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
    for (int p = 0; p < P.N(); ++p) ip.hat.push_back(R3(P[p].x, P[p].y, 0));
  }
  static R3 position(const Mesh& Th, int k, const R3& hat) {
    const Fem2D::R2 P = Th[k](Fem2D::R2(hat.x, hat.y));
    return R3(P.x, P.y, 0);
  }
  template <class Node>
  static void set_point(MeshPoint* mp, const Mesh& Th, const Node& node, const R3& x) {
    mp->set(Th, Fem2D::R2(x.x, x.y), Fem2D::R2(node.hat[0], node.hat[1]), Th[node.element],
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
  static R3 normal(const Vertices& x, int facet) {
    const int(&v)[3] = Fem2D::Tet::nvface[facet];
    const R3 N = ((x[v[1]] - x[v[0]]) ^ (x[v[2]] - x[v[0]])) / 2;
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
  static double integral(bool quadratic, bool corner) { return !quadratic ? 1 : corner ? -1 : 4; }
  static double own(std::size_t nodes) { return nodes == 3 ? 1. / 4 : 2. / 5; }
  static constexpr const char* known_counts = "the 3 of P1 and the 6 of P2";
  static void interpolate(const Element& K, Interpolation& ip) {
    ip.clear();
    Fem2D::InterpolationMatrix<R3> all(*K.tfe);
    all.set(K);
    for (int k = 0; k < all.ncoef; ++k) ip.add(all.dofe[k], all.comp[k], all.p[k], all.coef[k]);
    for (int p = 0; p < all.P.N(); ++p) ip.hat.push_back(all.P[p]);
  }
  static R3 position(const Mesh& Th, int k, const R3& hat) { return Th[k](hat); }
  template <class Node>
  static void set_point(MeshPoint* mp, const Mesh& Th, const Node& node, const R3& x) {
    mp->set(Th, x, as_R3(node.hat), Th[node.element], static_cast<int>(node.label),
            as_R3(node.point.normal), node.facet);
  }
};

/// Why a space cannot be used; the name of the space is put before it.
struct UnfitSpace : IllegalInput {
  using IllegalInput::IllegalInput;
};

[[noreturn]] void refuse_space(const std::string& why) {
  throw UnfitSpace(why +
                   "; contact needs a continuous vector Lagrange space such as [P1,P1], [P2,P2] or "
                   "[P1,P1,P1]");
}

/// The nodes of one facet: dofs of each component, grouped by the interpolation points they share.
struct FacetNodes {
  struct Node {
    std::array<Index, 3> dof{{-1, -1, -1}};
    R3 x, hat;
    bool corner = false;
  };
  std::vector<Node> node;
  /// The node at a point of the reference element, a new one if need be.
  Node& at(const R3& hat) {
    for (Node& n : node) {
      const R3 away = n.hat - hat;
      if (std::abs(away.x) + std::abs(away.y) + std::abs(away.z) < 1e-10) return n;
    }
    node.emplace_back().hat = hat;
    return node.back();
  }
};

/// The nodes of a facet in the order of BoundaryFacet::node.
std::vector<std::size_t> in_order(const FacetNodes& facet, int d) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < facet.node.size(); ++k)
    if (facet.node[k].corner) order.push_back(k);
  if (facet.node.size() == order.size()) return order;
  for (int edge = 0; edge < mortar::edges_of_facet(d); ++edge) {
    const auto [a, b] = mortar::edge_ends(d, edge);
    const R3 ends = facet.node[order[a]].hat + facet.node[order[b]].hat;
    for (std::size_t k = 0; k < facet.node.size(); ++k)
      if (Norme2(2. * facet.node[k].hat - ends) < 1e-10) order.push_back(k);
  }
  return order;
}

/// Refuses traces for which the laws are not written.
template <class FESpaceType>
void check_trace(const FacetNodes& facet) {
  using D = Dimension<FESpaceType>;
  if (facet.node.empty()) refuse_space("has no degree of freedom on the boundary");
  for (const FacetNodes::Node& n : facet.node)
    for (int c = 0; c < D::d; ++c)
      if (n.dof[c] < 0) refuse_space("mixes elements whose components have different nodes");
  if (!D::known_trace(facet.node.size()))
    refuse_space("has " + std::to_string(facet.node.size()) + " nodes on each boundary " +
                 D::facet_name + ", where the laws of contact are written for " + D::known_counts);
}

template <class FESpaceType>
class SpaceOn final : public Space {
  using D = Dimension<FESpaceType>;

 public:
  explicit SpaceOn(const FESpaceType& Vh, const Stage& stage = {}, Index offset = 0)
      : Space(D::d, stage, offset), keep_(const_cast<FESpaceType*>(&Vh)) {
    if (is_moved()) move_vertices();
  }
  SpacePtr at(const Stage& stage, Index offset) const override {
    return std::make_shared<const SpaceOn>(space(), stage, offset);
  }
  const FESpaceType& space() const { return *keep_; }
  const typename D::Mesh& mesh() const { return space().Th; }
  Index dofs() const override { return space().NbOfDF; }
  Index nodes() const override { return space().NbOfNodes; }
  Index vertices() const override { return mesh().nv; }
  Index elements() const override { return mesh().nt; }
  std::array<Index, 4> element(Index k) const override {
    std::array<Index, 4> vertex{{-1, -1, -1, -1}};
    for (int v = 0; v <= D::d; ++v) vertex[v] = mesh()(k, v);
    return vertex;
  }
  std::set<long> labels() const override {
    std::set<long> labels;
    for (int ib = 0; ib < D::facets(mesh()); ++ib) labels.insert(D::label(mesh(), ib));
    return labels;
  }
  std::vector<Index> mesh_nodes() const override {
    std::vector<Index> node(dofs());
    for (int k = 0; k < nodes(); ++k)
      for (int i = space().FirstDFOfNode(k); i < space().LastDFOfNode(k); ++i) node[i] = k;
    return node;
  }
  Boundary boundary(const std::vector<long>& labels, const SpaceInWords& words) const override;
  SharedNode node_at_vertex(Index element, int vertex) const override {
    const typename D::Element K(space()[element]);
    Interpolation ip;
    D::interpolate(K, ip);
    SharedNode node;
    for (const auto& e : ip.entries) {
      const R3& hat = ip.hat[e.point];
      if (corner_at(as_vector(hat), D::d) != vertex || e.coefficient != 1) continue;
      node.dof[e.component] = K(e.dof);
      node.x = as_vector(place(element, hat));
    }
    node.moved = as_vector(moved(node.dof));
    return node;
  }
  double thickness(Index element, int facet) const override {
    constexpr double thick = 4;  // deeper overlaps are none, whatever is there
    constexpr int n = D::d + 1;
    using Square = Eigen::Matrix<double, n, n>;
    using Point = Eigen::Matrix<double, n, 1>;
    const auto vertices = [&](Index k) {  // columns (x, 1)
      Square V;
      for (int v = 0; v < n; ++v) {
        const R3 hat(v == 1, v == 2, v == 3);
        V.col(v) << as_vector(D::position(mesh(), k, hat)).template head<D::d>(), 1;
      }
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
      if (out < 0) break;
      depth += std::max(0., step);
      if (D::outer(mesh(), element, out)) return depth;
      element = mesh().ElementAdj(element, out);
      from = out;
      lambda = vertices(element).inverse();
    }
    return infinity;
  }
  /// Elements with nothing new are passed over: most of them, in 3D.
  std::vector<NodePlace> places() const override {
    const std::vector<Index> body = body_of_element();
    std::vector<NodePlace> places, at_point;
    std::vector<char> seen(dofs(), 0);
    const auto is_new = [&](int dof) { return !seen[dof]; };
    for_each_element(is_new, [&](int k, const auto& K, const Interpolation& ip) {
      at_point.assign(ip.hat.size(), NodePlace());
      for (const auto& e : ip.entries)
        if (e.coefficient == 1) at_point[e.point].dof[e.component] = K(e.dof);
      for (std::size_t p = 0; p < at_point.size(); ++p) {
        NodePlace& n = at_point[p];
        bool whole = true;
        for (int c = 0; c < D::d; ++c) whole &= n.dof[c] >= 0;
        if (!whole || seen[n.dof[0]]) continue;
        n.x = as_vector(node(k, ip.hat[p], n.dof));
        n.body = body[k];
        places.push_back(n);
        seen[n.dof[0]] = 1;
      }
      for (int i = 0; i < K.NbDoF(); ++i) seen[K(i)] = 1;
    });
    return places;
  }
  std::vector<LabelledNode> labelled() const override {
    std::vector<LabelledNode> all;
    for (int ib = 0; ib < D::facets(mesh()); ++ib) {
      int facet;
      const int k = mesh().BoundaryElement(ib, facet);
      const Real measure = Norme2(D::normal(vertices_of(k), facet));
      const FacetNodes nodes = facet_nodes(k, facet);
      for (const FacetNodes::Node& n : nodes.node)
        all.push_back(
            {D::label(mesh(), ib), n.dof, measure * D::share(nodes.node.size(), n.corner), 0});
    }
    return all;
  }
  Vector unit_load(const std::vector<char>& of) const override {
    Vector load = Vector::Zero(dofs());
    const auto is_wanted = [&](int dof) { return of[dof] != 0; };
    for_each_element(is_wanted, [&](int k, const auto& K, const Interpolation& ip) {
      const auto at_corner = [&](int p) { return corner_at(as_vector(ip.hat[p]), D::d) >= 0; };
      const bool quadratic = std::any_of(ip.hat.begin(), ip.hat.end(), [](const R3& hat) {
        return hat.x + hat.y + hat.z == 0.5;  // in the middle of an edge, which no bubble is
      });
      const Real content = std::abs(D::content(vertices_of(k)));
      for (const auto& e : ip.entries)
        load[K(e.dof)] += content * D::integral(quadratic, at_corner(e.point));
    });
    return load;
  }
  Vec3 go_to(Stack stack, const BoundaryNode& node) const override {
    const auto& there = static_cast<const SpaceOn&>(node.is_begun ? *begun() : *this);
    const Vec3 x = as_vector(there.place(node.element, as_R3(node.hat))) + node.aside;
    D::set_point(MeshPointStack(stack), mesh(), node, as_R3(x));
    return x;
  }
  std::string moved_by() const { return stage_.name; }  ///< the argument
  /// A point of element k, by its place in the reference element.
  R3 place(int k, const R3& hat) const {
    R3 x = D::position(mesh(), k, hat);
    if (!is_moved()) return x;
    const double lambda[4] = {1 - hat.x - hat.y - hat.z, hat.x, hat.y, hat.z};
    for (int v = 0; v <= D::d; ++v) x += lambda[v] * (*of_vertex_)[mesh()(k, v)];
    return x;
  }
  Vertices vertices_of(int k) const {
    Vertices x;
    for (int v = 0; v <= D::d; ++v) x[v] = place(k, corner(v));
    return x;
  }
  /// The displacement of the node that has these dofs.
  R3 moved(const std::array<Index, 3>& dof) const {
    R3 u;
    for (int c = 0; c < D::d && is_moved(); ++c) u[c] = (*stage_.at)[offset_ + dof[c]];
    return u;
  }
  /// A node of element k itself: that of a P2 edge may have left the edge's middle.
  R3 node(int k, const R3& hat, const std::array<Index, 3>& dof) const {
    return D::position(mesh(), k, hat) + moved(dof);
  }
  /// Whether the displacement turns element k inside out, or flattens it.
  bool is_inverted(int k) const {
    constexpr double flat = 1e-9;
    if (!is_moved()) return false;
    Vertices X;
    for (int v = 0; v <= D::d; ++v) X[v] = D::position(mesh(), k, corner(v));
    return !(D::content(vertices_of(k)) > flat * D::content(X));
  }
  FacetNodes facet_nodes(int k, int facet) const {
    const typename D::Element K(space()[k]);
    Interpolation ip;
    D::interpolate(K, ip);
    std::map<int, int> uses;  // dof -> interpolation points it is made from
    for (const auto& e : ip.entries) ++uses[e.dof];
    FacetNodes found;
    for (const auto& e : ip.entries) {
      if (!D::on_facet(facet, K.DFOnWhat(e.dof))) continue;
      if (uses[e.dof] != 1 || e.coefficient != 1)
        refuse_space("has degrees of freedom that are not nodal values");
      const R3& hat = ip.hat[e.point];
      FacetNodes::Node& n = found.at(hat);
      n.x = place(k, hat);
      n.dof[e.component] = K(e.dof);
      n.corner = D::is_corner(K.DFOnWhat(e.dof));
    }
    check_trace<FESpaceType>(found);
    return found;
  }

 private:
  /// visit(k, element, interpolation), where a dof of the element is wanted.
  template <class Wanted, class Visit>
  void for_each_element(const Wanted& wanted, const Visit& visit) const {
    Interpolation ip;
    for (int k = 0; k < elements(); ++k) {
      const typename D::Element K(space()[k]);
      bool any = false;
      for (int i = 0; i < K.NbDoF() && !any; ++i) any = wanted(K(i));
      if (!any) continue;
      D::interpolate(K, ip);
      visit(k, K, ip);
    }
  }
  static R3 corner(int v) { return R3(v == 1, v == 2, v == 3); }
  /// Elements with no new vertex are passed over.
  void move_vertices() {
    const auto displacement = std::make_shared<std::vector<R3>>(mesh().nv);
    std::vector<char> known(mesh().nv, 0);
    Interpolation ip;
    for (int k = 0; k < mesh().nt; ++k) {
      bool news = false;
      for (int v = 0; v <= D::d; ++v) news = news || !known[mesh()(k, v)];
      if (!news) continue;
      const typename D::Element K(space()[k]);
      D::interpolate(K, ip);
      for (const auto& e : ip.entries) {
        const int v = corner_at(as_vector(ip.hat[e.point]), D::d);
        if (v < 0 || e.component >= D::d || e.coefficient != 1) continue;
        (*displacement)[mesh()(k, v)][e.component] = (*stage_.at)[offset_ + K(e.dof)];
        known[mesh()(k, v)] = 1;
      }
    }
    of_vertex_ = displacement;
  }

  CountPointer<FESpaceType> keep_;
  std::shared_ptr<const std::vector<R3>> of_vertex_;  ///< displacements; null: none
};

/// Collects the nodes of the contact boundary facet by facet.
template <class FESpaceType>
class BoundaryNodes {
  using D = Dimension<FESpaceType>;

 public:
  BoundaryNodes(const SpaceOn<FESpaceType>& Vh, const SpaceInWords& words,
                const std::vector<long>& labels)
      : words_(words), place_(Vh), Vh_(Vh.space()) {
    try {
      if (Vh_.N != D::d)
        refuse_space("has " + std::to_string(Vh_.N) + " component" + (Vh_.N > 1 ? "s" : "") +
                     " on a " + std::to_string(D::d) + "D mesh");
      std::map<long, std::vector<int>> facets;  // of each label, named once
      for (long label : labels) facets[label];
      for (int ib = 0; ib < D::facets(Vh_.Th); ++ib)
        if (const auto of = facets.find(D::label(Vh_.Th, ib)); of != facets.end())
          of->second.push_back(ib);
      for (long label : labels) {
        const auto of = facets.find(label);
        if (of == facets.end()) continue;
        if (of->second.empty()) refuse_absent(label);
        for (int ib : of->second) {
          int facet;
          const int k = Vh_.Th.BoundaryElement(ib, facet);
          add(label, k, facet);
        }
        facets.erase(of);
      }
    } catch (const UnfitSpace& e) {
      refuse(words.name, " ", e.what());
    }
  }
  Boundary take() { return {std::move(nodes_), std::move(facets_), place_.is_moved()}; }

 private:
  void add(long label, int k, int facet) {
    const Vec3 normal = as_vector(D::normal(place_.vertices_of(k), facet));
    const FacetNodes nodes = place_.facet_nodes(k, facet);
    if (!D::outer(Vh_.Th, k, facet)) refuse_inside(label, nodes.node.front().x);
    if (place_.is_inverted(k)) refuse_inverted(label, k, nodes);
    std::vector<std::size_t> place;
    for (const FacetNodes::Node& n : nodes.node) {
      const auto [entry, is_new] = node_of_dof_.emplace(n.dof[0], nodes_.size());
      const R3 aside = place_.is_moved() ? place_.node(k, n.hat, n.dof) - n.x : R3();
      if (is_new)
        nodes_.push_back(
            {n.dof, as_vector(n.x), as_vector(place_.moved(n.dof)), as_vector(aside), {}, {}});
      SharedNode& shared = nodes_[entry->second];
      if (is_elsewhere(as_vector(n.x), shared.x, normal, D::d)) shared.other = as_vector(n.x);
      const double share = length(normal) * D::share(nodes.node.size(), n.corner);
      shared.facets.push_back({label, k, facet, as_vector(n.hat), normal, share, facets_.size(),
                               D::own(nodes.node.size()), normal});
      place.push_back(entry->second);
    }
    facets_.push_back({label, normal, {}, k, facet});
    for (std::size_t n : in_order(nodes, D::d)) facets_.back().node.push_back(place[n]);
  }
  [[noreturn]] void refuse_absent(long label) const {
    std::ostringstream s;
    s << "label " << label << " is not on the boundary of " << words_.mesh
      << ", which has the labels";
    for (long present : place_.labels()) s << " " << present;
    throw IllegalInput(s.str());
  }
  [[noreturn]] void refuse_inside(long label, const R3& x) const {
    refuse("label ", label, " lies inside the body at ", mortar::place(D::d, as_vector(x)),
           ", with elements on both sides of its ", D::facet_name, "s; ", words_.inside);
  }
  /// By the middle of its facet, on the mesh.
  [[noreturn]] void refuse_inverted(long label, int k, const FacetNodes& facet) const {
    R3 middle;
    for (const FacetNodes::Node& n : facet.node)
      if (n.corner) middle += D::position(Vh_.Th, k, n.hat) / D::d;
    refuse(place_.moved_by(), " turns the element behind the ", D::facet_name, " at ",
           mortar::place(D::d, as_vector(middle)), " on label ", label,
           " inside out, or makes it flat; take a smaller increment of the load, or a "
           "part of the step");
  }

  const SpaceInWords& words_;
  const SpaceOn<FESpaceType>& place_;
  const FESpaceType& Vh_;
  std::map<int, std::size_t> node_of_dof_;  // first dof of a node -> its place in nodes_
  std::vector<SharedNode> nodes_;
  std::vector<BoundaryFacet> facets_;
};

template <class FESpaceType>
Boundary SpaceOn<FESpaceType>::boundary(const std::vector<long>& labels,
                                        const SpaceInWords& words) const {
  return BoundaryNodes<FESpaceType>(*this, words, labels).take();
}

template <class V>
SpacePtr space_of(Stack stack, Expression e, const char* name) {
  const typename V::FESpace* Vh = evaluated(name, [&] {
    typename V::pfes* p = GetAny<typename V::pfes*>((*e)(stack));
    return p && *p ? static_cast<typename V::FESpace*>(**p) : nullptr;
  });
  if (!Vh) refuse(name, " is not a finite-element space");
  return std::make_shared<const SpaceOn<typename V::FESpace>>(*Vh);
}

}  // namespace

SpacePtr space_of(Stack stack, int d, Expression e, const char* name) {
  return d == 2 ? space_of<v_fes>(stack, e, name) : space_of<v_fes3>(stack, e, name);
}

const Space* Space::begun() const {
  if (!begun_ && is_moved() && stage_.begun) begun_ = at({stage_.begun, nullptr, "uold"}, offset_);
  return begun_.get();
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

int corner_at(const Vec3& hat, int d) {
  const double lambda[4] = {1 - hat[0] - hat[1] - hat[2], hat[0], hat[1], hat[2]};
  for (int v = 0; v <= d; ++v)
    if (std::abs(lambda[v] - 1) < 1e-10) return v;
  return -1;
}

PointGuard::PointGuard(Stack stack)
    : stack_(stack), saved_(std::make_shared<const MeshPoint>(*MeshPointStack(stack))) {}
PointGuard::~PointGuard() {
  *MeshPointStack(stack_) = *static_cast<const MeshPoint*>(saved_.get());
}

}  // namespace frictioncg
