#include "assembly/mortar/mortar.h"

#include "assembly/mortar/geometric_stiffness.h"
#include "assembly/mortar/moments.h"
#include "assembly/mortar/self_contact.h"

namespace frictioncg::mortar {

namespace {

/// A weight below this is what rounding leaves of zero: the weights of a row sum up to 1.
constexpr Real negligible = 1e-15;
/// The cells of a facet that is covered as a whole fill it up to this share: cutting rounds.
constexpr Real uncovered = 1e-9;
/// Powers until what a law depends on itself by, a twentieth at most, is below rounding.
constexpr Index slow = 30;

Matrix identity(Index n) { return Matrix(Vector::Ones(n).asDiagonal()); }

/// (G x)_k, seen from node i: the entries of a row sum up to 0.
Vec3 relative(const Matrix& G, Index k, Index i, const std::vector<Vec3>& x) {
  Vec3 sum = Vec3::Zero();
  for (Matrix::InnerIterator it(G, k); it; ++it) sum += it.value() * (x[it.col()] - x[i]);
  return sum;
}

}  // namespace

/// Sums over the facets; then the rows are divided by D.
class Assembly {
  /// Integrals over the covered facets at a mid-edge, of phi_e times ...
  struct EdgeMoments {
    Real of_distance = 0;                             ///< ... the distance
    std::vector<std::pair<Index, Real>> of_vertices;  ///< ... lambda_v, v a node
  };

 public:
  Assembly(Arrangement& of, const Options& options)
      : of_(of),
        nodes_(of.nodes),
        options_(options),
        ownership_(*of.ownership),
        slopes_(nodes_.X, options.force, ownership_.normal),
        D_(Vector::Zero(size())),
        offset_(nodes_.X.size(), Vec3::Zero()),
        least_(nodes_.X.size(), infinity),
        faced_(nodes_.X.size()),
        statistics_(of.pairs.back().given + 1) {
    for (std::size_t p = 0; p < of.pairs.size(); ++p)
      add_pair(static_cast<Index>(p), of.slaves[p], of.masters[p], of.covers[p]);
  }
  void finish(Mortar& mortar) {
    const Index n = size();
    mortar.size_ = n;
    mortar.edges_ = std::move(edges_);
    place_removed();
    const Vector inverse = (D_.array() == 0).select(Vector::Ones(n), D_).cwiseInverse();
    mortar.N_ = Matrix(inverse.asDiagonal() * sparse(n, n, N_)).pruned(1., negligible);
    mortar.P_ = Matrix(inverse.asDiagonal() * sparse(n, n, P_)).pruned(1., negligible);
    set_nodes(mortar);
    EntryList rows;
    for (std::size_t k = 0; k < mortar.nodes_.size(); ++k)
      rows.emplace_back(static_cast<Index>(k), mortar.nodes_[k].node, 1);
    const Matrix K = sparse(static_cast<Index>(mortar.nodes_.size()), n, rows);
    mortar.S_ = K * Matrix(identity(n) + mortar.N_) * mortar.halving({}, false, -0.5);
    const auto take = [&](const Matrix& P) {
      mortar.P_ = P;
      mortar.G_ = mortar.S_ - Matrix(K * P);
    };
    take(mortar.P_);
    set_gaps(mortar);  // from the integrals as they are
    set_distances(mortar);
    set_distances_of_edges(mortar);
    for (const SlaveNode& node : mortar.nodes_)
      if (takes_removed_[node.node] && !ownership_.common.of_master[node.node])
        of_.choices[node.node].most_change = most_where_taken;
    for (const auto& [i, r] : ownership_.taken) of_.choices[i].most_change = most_where_taken;
    take(balanced(mortar.P_, mortar.G_, mortar.nodes_, nodes_.X, of_.choices));
    take(along_normals(mortar.P_, mortar.G_, mortar.nodes_, ownership_.common.of_master,
                       of_.masters, nodes_.X, of_.choices));
    const Crossings crossed =
        crossings(mortar.G_, mortar.nodes_, nodes_, ownership_.common.turns, faced_);
    take(across_gap(mortar.P_, mortar.G_, mortar.nodes_, nodes_.where_forces_act(), crossed));
    set_statistics(mortar);
    for (const auto& [where, slips] : ownership_.slipping)
      mortar.told_ = std::max(mortar.told_, slips.told);
    const auto sloped = slopes_.rows([this](Index i, Index r) { return takes(i, r); });
    mortar.stiffness_ = geometric_stiffness(mortar, of_, sloped, crossed, options_);
  }

 private:
  Index size() const { return static_cast<Index>(nodes_.X.size()); }
  /// Of the pair that the script gave.
  Statistics& statistics_of(Index p) { return statistics_[of_.pairs[p].given]; }
  bool is_mid_edge(Index i) const { return number_of_edge_.count(i) > 0; }
  bool is_held(const Facet& facet) const {
    return std::all_of(facet.node.begin(), facet.node.begin() + nodes_.dimension,
                       [this](Index i) { return ownership_.state[i] == Ownership::State::held; });
  }
  void add_pair(Index p, const Side& slave, const Side& master, const Cover& cover) {
    const Integration integration(slave, master, nodes_, options_);
    Statistics& s = statistics_of(p);
    s.visited += cover.visited;
    for (Index f = 0; f < slave.facets(); ++f) {
      const std::vector<Cell>& cells = cover.cells[f];
      if (cells.empty()) continue;
      if (cover.fraction[f] < 1 - uncovered) ++s.partly_covered;
      s.held_facets += is_held(slave.facet(f));
      const Part part{slave, master, f, cells};
      const Moments moments = integration.over(part);
      const Ownership::Carriers& carriers = ownership_.carriers[p][f];
      for_each_multiplier(part, moments, carriers,
                          [&](Index i, const auto& psi, const auto& kept, Real d) {
                            D_[i] += d;
                            add_multiplier(i, psi, part, moments, kept);
                          });
      for (int v = 0; v < slave.d; ++v)
        for (int w = 0; w < slave.d; ++w)
          if (carriers.leans_on(v, w)) leaning_.insert({part.node(v), part.node(w)});
      slopes_.add(part, moments, integration, carriers);
      if (slave.surface.quadratic) add_edges(slave, f, moments);
    }
  }
  /// psi: coefficients of the multiplier of node i over the lambda of the facet.
  void add_multiplier(Index i, const Eigen::RowVector3d& psi, const Part& part,
                      const Moments& moments, const std::array<bool, 3>& kept) {
    const int d = part.slave.d, nodes_m = nodes_of_facet(d, part.master.surface.quadratic);
    offset_[i] += (psi * moments.offset).transpose();
    const Real along = ownership_.normal[i].dot(part.slave.planes[part.facet].normal);
    least_[i] = std::min(least_[i], along * moments.least - moments.bulge);
    for (int v = 0; v < d; ++v)
      if (!kept[v]) removed_.emplace_back(i, part.node(v), psi.dot(moments.vertices.col(v)));
    for (int k = 0; part.slave.surface.quadratic && k < edges_of_facet(d); ++k)
      N_.emplace_back(i, part.node(d + k), psi.dot(moments.edges.col(k)));
    for (std::size_t c = 0; c < part.cells.size(); ++c) {
      const Facet& master = part.master.facet(part.cells[c].master);
      const Real weight = (psi * moments.master[c].leftCols(nodes_m)).sum();
      if (weight > 0) faced_[i][&master] += weight;
      for (int l = 0; l < nodes_m; ++l)
        P_.emplace_back(i, master.node[l], psi.dot(moments.master[c].col(l)));
    }
  }
  /// A node with the master's normal, and one of a slave that slips along itself beside another
  /// that is held, and has another normal: either lets slip what turns at its own place alone.
  bool may_take(Index i, Index r) const {
    return ownership_.common.of_master[i] ||
           (ownership_.state[r] == Ownership::State::held &&
            ownership_.normal[r] != ownership_.normal[i] && ownership_.slips(ownership_.pair[i]));
  }
  bool takes(Index i, Index r) const {
    return (takes_removed_[i] && may_take(i, r)) || ownership_.takes(i, r);
  }
  /// Such nodes take on themselves what removed nodes r move by. Where the weights of r, which have
  /// no sign on slivers, would take half of D_i, they stay those of r. The gap stays that of all.
  void place_removed() {
    Vector sum = Vector::Zero(size());
    for (const auto& e : removed_)
      if (may_take(e.row(), e.col())) sum[e.row()] += e.value();
    takes_removed_.assign(size(), 0);
    for (Index i = 0; i < size(); ++i)
      takes_removed_[i] = sum[i] != 0 && D_[i] + sum[i] > D_[i] / 2;
    for (const auto& e : removed_) {
      const Index i = e.row(), r = e.col();
      if (takes(i, r)) {
        D_[i] += e.value();
        offset_[i] -= e.value() * (nodes_.X[r] - nodes_.X[i]);
      } else {
        N_.emplace_back(i, r, e.value());
      }
    }
  }
  void add_edges(const Side& slave, Index f, const Moments& moments) {
    const auto& node = slave.facet(f).node;
    for (int k = 0; k < edges_of_facet(slave.d); ++k) {
      const auto [a, b] = edge_ends(slave.d, k);
      const Index e = node[slave.d + k];
      const auto [at, is_new] = number_of_edge_.emplace(e, static_cast<Index>(edges_.size()));
      if (is_new) {
        edges_.push_back({e, node[a], node[b], 0});
        edge_moments_.emplace_back();
      }
      EdgeMoments& sum = edge_moments_[at->second];
      sum.of_distance += moments.distance[k];
      for (int v = 0; v < slave.d; ++v) sum.of_vertices.emplace_back(node[v], moments.edges(v, k));
    }
  }
  void set_nodes(Mortar& mortar) const {
    for (Index i = 0; i < size(); ++i) {
      if (D_[i] == 0) continue;
      mortar.nodes_.push_back(
          {i, ownership_.pair[i], ownership_.label[i], normal_of(mortar.N_, i), D_[i]});
    }
  }
  /// Where a law leans on others, that of the place between: on a circle or a sphere its normal
  /// leads through the centre again, and no turn about that is held.
  Vec3 normal_of(const Matrix& N, Index i) const {
    const Vec3 own = ownership_.normal[i];
    Vec3 sum = own;
    bool differ = false;
    for (Matrix::InnerIterator it(N, i); it; ++it) {
      if (leaning_.count({i, it.col()}) == 0) continue;
      sum += it.value() * ownership_.normal[it.col()];
      differ = differ || ownership_.normal[it.col()] != own;
    }
    return differ ? Vec3(sum.normalized()) : own;
  }
  /// g_i = n_i.( -(G X)_i + int psi_i (delta_m(chi) - delta_s) / D_i ), X seen from X_i, but no
  /// less than the distance is anywhere: psi_i has negative parts, and before a kink of the master
  /// would see an overlap that is not there.
  void set_gaps(Mortar& mortar) const {
    for (std::size_t k = 0; k < mortar.nodes_.size(); ++k) {
      SlaveNode& node = mortar.nodes_[k];
      const Vec3 way =
          relative(mortar.G_, static_cast<Index>(k), node.node, nodes_.where_forces_act());
      node.gap = node.normal.dot(offset_[node.node] / node.weight - way);
      bool leans = takes_removed_[node.node] != 0;  // on others, before which it has a part
      for (Matrix::InnerIterator it(mortar.N_, node.node); it; ++it)
        if (!is_mid_edge(it.col())) node.own += it.value(), leans = true;
      if (!leans) node.gap = std::max(node.gap, least_[node.node]);
    }
  }
  /// Of where the vertices are: rows that lean on nodes of their patch are of where these end.
  void set_distances(Mortar& mortar) const {
    std::vector<Real> distance(nodes_.X.size(), 0);
    std::vector<SlaveNode*> leaning;
    const auto set_distance = [&](SlaveNode& node) {
      bool leans = false;
      Real rest = node.gap, own = 1;
      for (Matrix::InnerIterator it(mortar.N_, node.node); it; ++it) {
        const bool other = leaning_.count({node.node, it.col()}) > 0;
        leans = leans || other;
        if (other) rest -= it.value() * distance[it.col()];
        if (!other && !is_mid_edge(it.col())) own += it.value();
      }
      distance[node.node] = node.distance = rest / own;
      return leans;
    };
    for (SlaveNode& node : mortar.nodes_)
      if (set_distance(node)) leaning.push_back(&node);
    // those that lean on such as lean, too, once these are settled
    bool changed = true;
    for (std::size_t link = 0; link < leaning.size() && changed; ++link) {
      changed = false;
      for (SlaveNode* node : leaning) {
        const Real before = node->distance;
        set_distance(*node);
        changed = changed || node->distance != before;
      }
    }
  }
  /// g_e = (g_a + g_b)/2 + int phi_e (g - sum_v lambda_v g_v) / int phi_e: as exact on parts of a
  /// facet as on the whole. Where vertices carry no law, the mean of g, weighted by phi_e.
  void set_distances_of_edges(Mortar& mortar) const {
    std::vector<const SlaveNode*> at(nodes_.X.size(), nullptr);
    for (const SlaveNode& node : mortar.nodes_) at[node.node] = &node;
    for (std::size_t k = 0; k < mortar.edges_.size(); ++k) {
      MidEdge& e = mortar.edges_[k];
      Real room = 0, linear = 0;
      bool laws = true;
      for (const auto& [v, moment] : edge_moments_[k].of_vertices) {
        room += moment;
        laws = laws && at[v] != nullptr;
        if (laws) linear += moment * at[v]->distance;
      }
      e.distance = room > 0 ? (edge_moments_[k].of_distance - (laws ? linear : 0)) / room : 0;
      if (laws) e.distance += (at[e.a]->distance + at[e.b]->distance) / 2;
    }
  }
  void set_statistics(Mortar& mortar) {
    using State = Ownership::State;
    for (Index i = 0; i < size(); ++i) {
      const State state = ownership_.state[i];
      if (state == State::uncovered || state == State::kept) continue;
      Statistics& s = statistics_of(ownership_.pair[i]);
      ++s.removed;
      if (state == State::held && s.held++ == 0) s.first_held = i;
    }
    for (const SlaveNode& node : mortar.nodes_) {
      Statistics& s = statistics_of(node.pair);
      const bool first = s.facing++ == 0;
      s.least_gap = first ? node.gap : std::min(s.least_gap, node.gap);
      s.largest_gap = first ? node.gap : std::max(s.largest_gap, node.gap);
    }
    mortar.statistics_ = std::move(statistics_);
  }

  Arrangement& of_;  ///< whose choices are added to
  const Nodes& nodes_;
  const Options& options_;
  const Ownership& ownership_;
  WeightSlopes slopes_;
  Vector D_;
  EntryList N_, P_, removed_;                  ///< the last: (i, r), int psi_i lambda_r
  std::set<std::pair<Index, Index>> leaning_;  ///< nodes beyond, and those of their facets before
  std::vector<char> takes_removed_;            ///< per node
  std::vector<Vec3> offset_;                   ///< int psi_i (delta_m(chi) - delta_s)
  std::vector<Real> least_;                    ///< distance along n_i, at most by the offset less
  FacedFacets faced_;                          ///< per node
  std::map<Index, Index> number_of_edge_;      ///< in edges_, by node
  std::vector<MidEdge> edges_;
  std::vector<EdgeMoments> edge_moments_;  ///< in their order
  std::vector<Statistics> statistics_;     ///< per pair that was given
};

namespace {

/// What t.G(u - u_old) lacks of a slip that does not see how the bodies turn. Along smooth surfaces
/// G x has the offset of the facets, which a rigid turn rotates; the change of G does not.
/// Puso and Laursen 2004
///
///   slip = -(G - G_old) x,    c = slip - G (x - x_old) = G_old x - 2 G x + G x_old
///
/// x, x_old: the nodes now, and where the increment began. One vector for each contact node of
/// `now`, as a motion of its own node; 0 where nothing was before it then.
std::vector<Vec3> slip_beside(const Mortar& now, const std::vector<Vec3>& x, const Mortar& old,
                              const std::vector<Vec3>& x_old) {
  std::vector<Index> row_of(x.size(), -1);  // of a node in G_old
  for (std::size_t k = 0; k < old.nodes().size(); ++k)
    row_of[old.nodes()[k].node] = static_cast<Index>(k);
  std::vector<Vec3> c;
  for (const SlaveNode& node : now.nodes()) {
    const Index k = static_cast<Index>(c.size()), i = node.node;
    c.push_back(Vec3::Zero());
    if (row_of[i] < 0) continue;
    const Matrix& G = now.relative();
    const Vec3 sum = relative(old.relative(), row_of[i], i, x) - 2 * relative(G, k, i, x) +
                     relative(G, k, i, x_old);
    c[k] = sum / G.coeff(k, i);
  }
  return c;
}

/// Straightens edges of the slaves that hardly are before a master: in 3D laws beside its ends
/// would come and go with edges that bend there.
void straighten_beside_ends(const Sides& begun, Nodes& nodes) {
  constexpr Real hardly = 0.02;
  std::set<Index> all, facing;
  const auto add = [d = nodes.dimension](const Facet& facet, std::set<Index>& to) {
    to.insert(facet.node.begin() + d, facet.node.end());
  };
  for (std::size_t p = 0; p < begun.slaves.size(); ++p)
    for (Index f = 0; f < begun.slaves[p].facets(); ++f) {
      const Facet& slave = begun.slaves[p].facet(f);
      add(slave, begun.covers[p].fraction[f] < hardly ? all : facing);
      for (const Cell& cell : begun.covers[p].cells[f])
        add(begun.masters[p].facet(cell.master), facing);
    }
  for (Index e : all)
    if (e >= 0 && facing.count(e) == 0) nodes.bent[e] = nodes.X[e];
}

/// The pairs of X with their nodes at Y: outside stays outside.
std::vector<Pair> carried(int d, std::vector<Pair> pairs, const std::vector<Vec3>& X,
                          const std::vector<Vec3>& Y) {
  for (Pair& pair : pairs)
    for (Surface* surface : {&pair.slave, &pair.master}) {
      const std::vector<Plane> planes = planes_at(d, *surface, X, Y);
      for (std::size_t f = 0; f < planes.size(); ++f) surface->facets[f].outward = planes[f].normal;
    }
  return pairs;
}

}  // namespace

std::vector<Vec3> straightened(int d, const std::vector<Pair>& pairs, std::vector<Vec3> X) {
  for (const Pair& pair : pairs)
    for (const Surface* surface : {&pair.slave, &pair.master})
      for (const Facet& f : surface->facets)
        for (int k = 0; k < edges_of_facet(d) && surface->quadratic; ++k) {
          const auto [a, b] = edge_ends(d, k);
          X[f.node[d + k]] = (X[f.node[a]] + X[f.node[b]]) / 2;
        }
  return X;
}

Mortar::Mortar(const Nodes& all, const std::vector<Pair>& given, const Options& options) {
  const int d = all.dimension;
  const bool quadratic = std::any_of(given.begin(), given.end(), [](const Pair& p) {
    return p.slave.quadratic || p.master.quadratic;
  });
  const auto straight = [&](const std::vector<Vec3>& places) {
    Nodes nodes = all;
    nodes.X = straightened(d, given, places);
    if (quadratic) nodes.bent = places;
    return nodes;
  };
  Nodes nodes = all.reference.empty() ? all : straight(all.X);
  std::vector<Roles> roles;
  const auto part = [&](const std::vector<Pair>& pairs) {
    return parted(pairs, roles, !nodes.reference.empty());
  };
  const auto make = [&](const Arrangement* begun) {
    Arrangement now(nodes, part(given), options, begun);
    for (const Pair& pair : now.pairs) labels_.push_back(pair.slave.labels);
    validate_cover(now, options);
    Assembly(now, options).finish(*this);
  };
  if (nodes.before.empty()) {
    find_roles(nodes, given, options.maxgap, roles);
    make(nullptr);
    return;
  }
  Nodes then = straight(nodes.before);
  const std::vector<Pair> given_then = carried(d, given, nodes.X, then.X);
  find_roles(then, given_then, options.maxgap, roles);
  find_roles(nodes, given, options.maxgap, roles);  // and of what faces itself by now
  // What decides where an increment begins knows of no forces, nor of normals given for now.
  Options plain = options;
  plain.force.clear();
  if (!options.normals.empty()) plain.freedom = nullptr;
  plain.normals.clear();
  Arrangement begun(then, part(given_then), plain);
  if (quadratic && d == 3)
    for (Nodes* at : {&nodes, &then}) straighten_beside_ends(begun, *at);
  Mortar old;
  if (options.normals.empty()) Assembly(begun, plain).finish(old);
  make(&begun);
  if (options.normals.empty()) slip_ = slip_beside(*this, all.X, old, nodes.before);
}

Vector Mortar::weighted(const std::vector<NodeGap>& given) const {
  std::vector<std::size_t> first(static_cast<std::size_t>(size_), given.size());
  for (std::size_t p = given.size(); p-- > 0;) first[given[p].node] = p;
  const auto seen = [&](const SlaveNode& from, Index i) {
    const std::vector<long>& face = labels_[from.pair];
    const auto begin = given.begin() + static_cast<std::ptrdiff_t>(first[i]);
    const auto end =
        std::find_if(begin, given.end(), [i](const NodeGap& g) { return g.node != i; });
    auto at = std::find_if(begin, end, [&](const NodeGap& g) { return g.label == from.label; });
    if (at == end)
      at = std::find_if(begin, end, [&face](const NodeGap& g) {
        return std::find(face.begin(), face.end(), g.label) != face.end();
      });
    return at == end ? begin->gap : at->gap;
  };
  Vector gap = Vector::Zero(S_.rows());
  for (Index k = 0; k < gap.size(); ++k)
    for (Matrix::InnerIterator it(S_, k); it; ++it)
      gap[k] += it.value() * seen(nodes_[k], it.col());
  return gap;
}

/// The identity with `half` of each end in the rows of mid-edges, of those held or of the others.
Matrix Mortar::halving(const std::vector<char>& held, bool where_held, Real half) const {
  EntryList entries;
  for (Index i = 0; i < size_; ++i) entries.emplace_back(i, i, 1);
  for (const MidEdge& e : edges_) {
    if ((!held.empty() && held[e.node]) != where_held) continue;
    entries.emplace_back(e.node, e.a, half);
    entries.emplace_back(e.node, e.b, half);
  }
  return sparse(size_, size_, entries);
}

/// With u = C u^, C the identity at held mid-edges, and w = u^ but at contact nodes:
/// (I + N H - P C L) u^ = (I + P C (I - L)) w, where H u^ gives the u~ of held mid-edges, and L
/// takes contact nodes; rows of N and P vanish at held nodes. Powers of N H - P C L vanish: no law
/// depends on itself (Ownership::break_rings), or by next to nothing, where a node that leans on
/// another is removed on a sliver of that one's.
Matrix Mortar::change_of_basis(const std::vector<char>& held) const {
  Vector free = Vector::Ones(size_), on_laws = Vector::Zero(size_);
  for (std::size_t i = 0; i < held.size(); ++i) free[static_cast<Index>(i)] = !held[i];
  for (const SlaveNode& node : nodes_) on_laws[node.node] = free[node.node];
  const Matrix C = halving(held, false, 0.5);
  const Matrix P = Matrix(free.asDiagonal() * P_) * C;
  const Matrix to_laws = Matrix(P * on_laws.asDiagonal()).pruned(1., 0.);
  Matrix N = Matrix(free.asDiagonal() * N_) * halving(held, true, -0.5);
  N -= to_laws;
  Matrix term = identity(size_) + P - to_laws, sum = term;
  for (Index power = 0; term.nonZeros() > 0; ++power) {
    if (power > size_ + slow) throw std::logic_error("the mortar's nodes depend on each other");
    term = Matrix(-(N * term)).pruned(1., negligible);
    sum += term;
  }
  return C * sum;
}

Matrix Mortar::inverse_basis(const std::vector<char>& held) const {
  EntryList rows;
  std::vector<char> relative(size_, 0);
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Index i = nodes_[k].node;
    if (!held.empty() && held[i]) continue;
    relative[i] = 1;
    for (Matrix::InnerIterator it(G_, static_cast<Index>(k)); it; ++it)
      rows.emplace_back(i, it.col(), it.value());
  }
  const Matrix inverse_of_C = halving(held, false, -0.5);
  for (Index i = 0; i < size_; ++i)
    for (Matrix::InnerIterator it(inverse_of_C, i); it && !relative[i]; ++it)
      rows.emplace_back(i, it.col(), it.value());
  return sparse(size_, size_, rows);
}

}  // namespace frictioncg::mortar
