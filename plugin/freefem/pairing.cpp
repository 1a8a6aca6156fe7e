#include "pairing.h"

#include "../core/assembly/mortar/topology.h"
#include "../core/linear_algebra.h"

namespace frictioncg {

namespace {

constexpr const char* pair_inside =
    "contact of two bodies needs two faces there, and meshes that were merged, as + does with near "
    "vertices, have none: use one space per mesh, or join them apart and move them back with "
    "movemesh, in 3D with cleanmesh=false";

/// Fills an Interface from the two sides, which have the labels of all pairs.
class InterfaceBuilder {
 public:
  InterfaceBuilder(const Spaces& spaces, const PairLabels& labels)
      : bodies_of_slave_(labels.pairs.size()) {
    const SpacePtr slave = spaces.front(), master = spaces.back();
    all_.d = slave->d;
    all_.is_moved = slave->is_moved();
    all_.pairs = labels.pairs;
    const bool in_one_space = slave == master;
    if (in_one_space) body_ = slave->body_of_element();
    Boundary side = slave->boundary(labels.slave, pair_inside);
    all_.slave = side.nodes;
    add(*slave, side, &mortar::Pair::slave);
    std::vector<int> element;
    for (const SharedNode& n : side.nodes) element.push_back(n.facets.front().element);
    all_.slave_bodies = [slave, element] {
      const std::vector<Index> of_element = slave->body_of_element();
      std::vector<Index> body;
      for (int k : element) body.push_back(of_element[k]);
      return body;
    };
    side = master->boundary(labels.master, pair_inside);
    add(*master, side, &mortar::Pair::master);
    all_.groups.assign(all_.X.size(), 1);
    if (in_one_space) count_groups(*master, side);
  }
  Interface take() { return std::move(all_); }

 private:
  /// Each pair takes the facets of its labels.
  void add(const Space& space, const Boundary& side, mortar::Surface mortar::Pair::*which) {
    const bool is_master = which == &mortar::Pair::master;
    std::map<long, std::set<std::size_t>> of_label;
    for (std::size_t p = 0; p < all_.pairs.size(); ++p)
      for (long label : (all_.pairs[p].*which).labels) of_label[label].insert(p);
    std::vector<Index> number;
    for (const SharedNode& n : side.nodes) {
      number.push_back(node(n));
      const Vec3 &x = all_.X[number.back()], other = n.other.value_or(n.x + n.aside);
      if (is_elsewhere(other, x, n.facets.front().normal, space.d))
        refuse(space.name, " is periodic, and ", mortar::place(space.d, x), " and ",
               mortar::place(space.d, other), " on label ", n.facets.front().label,
               " are one node, which may not touch another body; end the label before the seam, "
               "hold its sides by on() in place of the period, or let one of the bodies be an "
               "obstacle");
    }
    for (const BoundaryFacet& f : side.facets) {
      mortar::Facet facet;
      facet.label = f.label;
      facet.outward = f.normal;
      if (!body_.empty()) {
        facet.body = body_[f.element];
        facet.thickness = space.thickness(f.element, f.facet);
      }
      for (std::size_t k = 0; k < f.node.size(); ++k) facet.node[k] = number[f.node[k]];
      if (is_master) look_behind(space, f, facet);
      for (std::size_t p : of_label[f.label]) {
        if (is_master)  // such as the faces of a crack
          facet.one_body = !body_.empty() && bodies_of_slave_[p].count(facet.body) > 0;
        else
          bodies_of_slave_[p].insert(facet.body);
        mortar::Surface& surface = all_.pairs[p].*which;
        surface.quadratic = static_cast<int>(f.node.size()) > space.d;
        surface.facets.push_back(facet);
      }
    }
  }
  /// Of the element behind a facet of the master.
  void look_behind(const Space& space, const BoundaryFacet& f, mortar::Facet& facet) {
    const SharedNode n = space.node_at_vertex(f.element, f.facet);
    const Index i = node(n);
    if (!is_elsewhere(n.x, all_.X[i], f.normal, space.d)) facet.behind = i;
  }
  /// The number of a node, a new one if need be.
  Index node(const SharedNode& n) {
    const auto [entry, is_new] = number_.emplace(n.dof[0], static_cast<Index>(all_.X.size()));
    if (is_new) {
      all_.X.push_back(n.x + n.aside);
      all_.moved.push_back(n.moved);
      all_.dof.push_back(n.dof);
    }
    return entry->second;
  }
  /// How many bodies meet at each vertex that both sides have.
  void count_groups(const Space& space, const Boundary& master) {
    std::map<long, Index> shared;  // vertex of the mesh -> node
    for (const SharedNode& n : master.nodes) {
      const Index i = number_.at(n.dof[0]);
      const AdjacentFacet& f = n.facets.front();
      const int corner = corner_at(f.hat, space.d);
      if (i < static_cast<Index>(all_.slave.size()) && corner >= 0)
        shared[space.element(f.element)[corner]] = i;
    }
    if (shared.empty()) return;
    std::map<Index, std::vector<std::array<Index, 4>>> around;
    for (Index k = 0; k < space.elements(); ++k) {
      const std::array<Index, 4> element = space.element(k);
      for (int v = 0; v <= space.d; ++v)
        if (const auto found = shared.find(element[v]); found != shared.end())
          around[found->second].push_back(element);
    }
    for (const auto& [i, elements] : around)
      all_.groups[i] = mortar::facet_connected_groups(space.d, elements);
  }

  std::vector<Index> body_;  ///< of each element, where both sides are in one space
  std::vector<std::set<Index>> bodies_of_slave_;  ///< of each pair
  Interface all_;
  std::map<Index, Index> number_;  ///< first dof of a node -> its number
};

/// Gram matrices of rigid motions, k x k of each body, side by side.
struct Gram {
  DenseMatrix in_A, in_D, held;  ///< in A, in its diagonal, and over what Dirichlet conditions hold
};

/// Of the motions of rigid_modes, over the dofs that each process owns.   Collective.
Gram gram_of(const Triplets& A, const Dirichlet& dirichlet, const std::vector<NodePlace>& places,
             int d, const Extent& extent, Index bodies, const Processes& all) {
  using Rows = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Index k = rigid_components(d);
  Gram gram;
  gram.in_A = gram.in_D = gram.held = DenseMatrix::Zero(k, k * bodies);
  all.agree([&] {
    const Rows w = rigid_modes(places, d, A.n, extent);
    Rows Aw = Rows::Zero(A.n, k);
    std::vector<Index> of = body_of_dofs(places, d, A.n);
    std::replace_if(
        of.begin(), of.end(), [bodies](Index body) { return body >= bodies; }, -1);
    Vector D = Vector::Zero(A.n);
    for_each_entry(A, [&](Index i, Index j, Real a) {
      if (of[i] < 0 || of[i] != of[j] || dirichlet.holds(i) || dirichlet.holds(j)) return;
      Aw.row(i) += a * w.row(j);
      if (i == j) D[i] += a;
    });
    for (Index i = 0; i < A.n; ++i) {
      if (of[i] < 0 || !all.owns(i)) continue;
      const auto add_to = [&](DenseMatrix& sum, const auto& row) {
        sum.middleCols(k * of[i], k).noalias() += w.row(i).transpose() * row;
      };
      if (dirichlet.holds(i)) add_to(gram.held, w.row(i));
      add_to(gram.in_A, Aw.row(i));
      add_to(gram.in_D, D[i] * w.row(i));
    }
  });
  for (DenseMatrix* sums : {&gram.in_A, &gram.in_D, &gram.held})
    all.sum(sums->data(), static_cast<Index>(sums->size()));
  return gram;
}

}  // namespace

Interface interface_of(const Spaces& spaces, const PairLabels& labels) {
  return InterfaceBuilder(spaces, labels).take();
}

Index count_of(const std::vector<Index>& body) {
  return body.empty() ? 0 : *std::max_element(body.begin(), body.end()) + 1;
}

mortar::Freedom freedom_of(const Triplets& A, const Dirichlet& dirichlet,
                           const std::vector<NodePlace>& places, int d, const Extent& extent,
                           std::vector<Index> body, Index bodies, const Processes& all) {
  constexpr Real resisted = 1e-10;  // <Aw,w>/<Dw,w>, a free motion's: supports are beyond rounding
  constexpr Real rigid = 1e30;      // the stiffness of a body of which all is held
  mortar::Freedom freedom{{d, extent.mean, extent.radius}, std::move(body), {}, {}, {}};
  const Gram gram = gram_of(A, dirichlet, places, d, extent, bodies, all);
  const Index k = freedom.generators.count();
  for (Index b = 0; b < bodies; ++b) {
    const DenseMatrix D = gram.in_D.middleCols(k * b, k), in_A = gram.in_A.middleCols(k * b, k);
    DenseMatrix support = rigid * DenseMatrix::Identity(k, k), free(k, 0);
    if (D.trace() > 0) {
      support = D.trace() * gram.held.middleCols(k * b, k);
      const Eigenpairs found = eigenpairs(in_A + support, D + support);
      Index count = 0;
      while (count < k && found.values[count] <= resisted) ++count;
      free = found.vectors.leftCols(count);
    }
    freedom.of_body.push_back(free);
    freedom.stiffness.push_back(in_A + support + resisted * D);
    freedom.support.push_back(support);
  }
  return freedom;
}

void FacedPart::add(const mortar::SlaveNode& m) {
  gap.push_back(m.gap);
  distance.push_back(m.distance);
  own.push_back(m.own);
}

void FacedPart::add(const mortar::Pair& pair, const mortar::Statistics& found, int d,
                    const std::vector<Vec3>& X) {
  pairs.push_back({mortar::labels_of(pair.slave) + " on " + mortar::labels_of(pair.master),
                   pair.slave.facets.size(), pair.master.facets.size(), found,
                   found.held > 0 ? mortar::place(d, X[found.first_held]) : ""});
}

std::vector<BoundaryNode> Pairing::face(const Triplets& A, mortar::Options options,
                                        const Vector& u_old,
                                        const std::vector<BoundaryNode>& on_obstacle,
                                        const std::function<std::vector<NodePlace>()>& places,
                                        bool again) {
  const std::vector<ContactPoint> obstacle = points_of(on_obstacle);
  NodeDofs may_touch = dofs_of(obstacle);
  may_touch.insert(may_touch.end(), between_.dof.begin(), between_.dof.end());
  dirichlet_ = std::make_shared<const Dirichlet>(A, may_touch);
  bool asked = false;
  options.element_groups = [this](Index i) { return between_.groups[i]; };
  options.bodies = between_.slave_bodies;
  options.freedom = [&] {
    asked = true;
    const std::vector<NodePlace> all = places();
    const std::vector<Index> body = body_of_nodes(between_.dof, all, between_.d, A.n);
    return freedom_of(A, *dirichlet_, all, between_.d, extent_of(between_.X), body, count_of(body));
  };
  const mortar::Nodes nodes = nodes_at(u_old, obstacle);
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
  for (const mortar::SlaveNode& m : mortar_->nodes()) {
    contact.push_back(contact_node(m.node, m));
    faced.add(m);
  }
  add_motions(*mortar_, between_.moved, contact);
  const auto taken = [this](Index node) { return !taken_.empty() && taken_[node]; };
  for (mortar::MidEdge e : mortar_->edges()) {  // of whose ends an obstacle has one at most
    if (taken(e.node) || (taken(e.a) && taken(e.b))) continue;
    if (taken(e.a)) e.a = e.b;
    if (taken(e.b)) e.b = e.a;
    faced.edges.push_back(e);
  }
  for (std::size_t p = 0; p < between_.pairs.size(); ++p)
    faced.add(between_.pairs[p], mortar_->statistics(static_cast<Index>(p)), between_.d,
              between_.X);
  set(std::move(faced));
  return contact;
}

void Pairing::add_motions(const mortar::Mortar& mortar, const std::vector<Vec3>& U,
                          std::vector<BoundaryNode>& contact) {
  for (std::size_t k = 0; k < contact.size() && !U.empty(); ++k)
    for (Matrix::InnerIterator G(mortar.relative(), static_cast<Index>(k)); G; ++G)
      contact[k].moved += G.value() * U[G.col()];
  for (std::size_t k = 0; k < mortar.slip().size(); ++k) contact[k].slid = mortar.slip()[k];
}

BoundaryNode Pairing::contact_node(Index i, const mortar::SlaveNode& m) const {
  BoundaryNode node = slave_node(i, m.label);
  node.point.normal = node.mean = m.normal;
  node.weight = m.weight;
  return node;
}

std::unique_ptr<LocalSystem> Pairing::system(const Triplets& A, std::vector<ContactPoint> points,
                                             const std::vector<Index>& mesh_node,
                                             const BodyShape& shape,
                                             const LocalSystem* before) const {
  const Coupling coupling =
      mortar::couple(*mortar_, between_.d, between_.dof, *dirichlet_, A.n, taken_);
  return std::make_unique<LocalSystem>(A, between_.d, std::move(points), mesh_node, *dirichlet_,
                                       coupling, shape, before);
}

std::vector<BoundaryNode> Pairing::slave_nodes() const {
  std::vector<BoundaryNode> nodes;
  for (std::size_t i = 0; i < between_.slave.size(); ++i)
    nodes.push_back(slave_node(static_cast<Index>(i), between_.slave[i].facets.front().label));
  return nodes;
}

Vector Pairing::gap() const {
  return Eigen::Map<const Vector>(faced_.gap.data(), static_cast<Index>(faced_.gap.size()));
}

Matrix Pairing::stiffness(Index n) const {
  EntryList entries;
  mortar_->stiffness().for_each_symmetric(between_.d, [&](Index i, int a, Index j, int b, Real s) {
    const Index k = between_.dof[i][a], l = between_.dof[j][b];
    if (!dirichlet_->holds(k) && !dirichlet_->holds(l)) entries.emplace_back(k, l, s);
  });
  return sparse(n, n, entries);
}

mortar::Change Pairing::change(const std::vector<Vec3>& v) const {
  return mortar::change(*mortar_, v, mortar::straightened(between_.d, between_.pairs, v));
}

Vector Pairing::on_free_dofs(const std::vector<Vec3>& of_node, Index n) const {
  Vector of_dof = Vector::Zero(n);
  for (std::size_t i = 0; i < of_node.size(); ++i)
    for (int c = 0; c < between_.d; ++c)
      if (const Index k = between_.dof[i][c]; !dirichlet_->holds(k)) of_dof[k] = of_node[i][c];
  return of_dof;
}

std::vector<Vec3> Pairing::at_nodes(const Vector& u) const {
  std::vector<Vec3> of_node(between_.dof.size(), Vec3::Zero());
  for (std::size_t i = 0; i < of_node.size(); ++i)
    for (int c = 0; c < between_.d; ++c) of_node[i][c] = u[between_.dof[i][c]];
  return of_node;
}

mortar::Nodes Pairing::nodes_at(const Vector& u_old,
                                const std::vector<ContactPoint>& obstacle) const {
  const Interface& all = between_;
  mortar::Nodes nodes{all.d, all.X, mortar::held_components(all.d, all.dof, *dirichlet_)};
  std::set<Index> of_obstacle;
  for (const ContactPoint& p : obstacle) of_obstacle.insert(p.dof[0]);
  for (std::size_t i = 0; i < all.dof.size() && !obstacle.empty(); ++i)
    nodes.taken.push_back(of_obstacle.count(all.dof[i][0]) > 0);
  std::vector<Vec3> before;
  if (u_old.size() > 0) before = at_nodes(u_old);
  for (std::size_t i = 0; i < all.X.size() && all.is_moved; ++i) {
    nodes.reference.push_back(all.X[i] - all.moved[i]);
    if (u_old.size() > 0) nodes.before.push_back(nodes.reference[i] + before[i]);
  }
  return nodes;
}

BoundaryNode Pairing::slave_node(Index i, long label) const {
  const SharedNode& shared = between_.slave[i];
  const auto has_it = [label](const AdjacentFacet& f) { return f.label == label; };
  auto facet = std::find_if(shared.facets.begin(), shared.facets.end(), has_it);
  if (facet == shared.facets.end()) facet = shared.facets.begin();
  BoundaryNode node{*facet};
  node.point.dof = shared.dof;
  node.point.normal = facet->normal / length(facet->normal);
  node.x = shared.x;
  return node;
}

}  // namespace frictioncg
