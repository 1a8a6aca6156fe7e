#include "assembly/mortar/ownership.h"

#include <tuple>

#include "assembly/mortar/self_contact.h"
#include "assembly/mortar/sheets.h"

namespace frictioncg::mortar {

namespace {

/// One vertex stands for a facet of which less than this share is covered; from twice as much on
/// each has its part, and between the two both ways share it: nothing jumps as bodies slide.
constexpr Real barely = 1e-3;
/// Along a path a node beyond keeps the law that it begins with down to `barely_kept`, and gets one
/// from `for_a_law` on: on a sliver that is as hard as any other, and pushes a corner back over its
/// vertex.
constexpr Real barely_kept = 1e-5, for_a_law = 0.02;

Index label_position(const Surface& surface, long label) {
  const auto at = std::find(surface.labels.begin(), surface.labels.end(), label);
  return static_cast<Index>(at - surface.labels.begin());
}

/// The normals by which it is decided whether Dirichlet conditions hold them: those of the bodies
/// as they are not deformed. Along a path a node on an axis or on a plane of symmetry keeps its
/// law, whatever the normal of its facets, which lie on one side of it, does there.
std::vector<Vec3> undeformed_normals(const Sides& of, const Options& options, const Owns& owns,
                                     const std::vector<Vec3>& now) {
  const Nodes& nodes = of.nodes;
  bool any = false;  // of those with a normal
  for (std::size_t i = 0; i < now.size(); ++i)
    any = any || (nodes.held[i] != 0 && !now[i].isZero(0));
  if (!any || nodes.reference.empty() || !options.normals.empty()) return now;
  Nodes at_rest = nodes;
  at_rest.X = nodes.reference;
  Sides sides{at_rest};
  for (const Side& slave : of.slaves) sides.slaves.push_back(slave.at_rest(nodes.X, at_rest.X));
  Slipping slipping;
  return slave_normals(sides, options, owns, slipping);
}

/// Sorted, patches come as they are ranked.
struct Patch {
  Index pair, label = std::numeric_limits<Index>::max();
  Real uncovered = 0;  ///< minus the covered measure
  std::vector<Index> facets;
  bool operator<(const Patch& o) const {
    return std::tie(pair, label, uncovered, facets) <
           std::tie(o.pair, o.label, o.uncovered, o.facets);
  }
};

}  // namespace

Ownership::Ownership(Sides& of, const Options& options, const Arrangement* begun)
    : state(of.nodes.X.size(), State::uncovered),
      label(of.nodes.X.size(), 0),
      common(of.nodes.X.size()) {
  const Nodes& nodes = of.nodes;
  if (begun) {
    static_cast<Ranked&>(*this) = *begun->ownership;
    own(of, nullptr);
  } else {
    rank_patches(of);
    const Ways ways(of, rank);
    own(of, &ways);
  }
  set_labels(of.slaves);
  const Owns owns = [&](std::size_t p, Index f, Index i) { return owner[i] == rank[p][f]; };
  normal = slave_normals(of, options, owns, slipping);
  if (options.normals.empty()) {
    common = choose_common_normals(of, options, owns, begun ? &begun->ownership->common : nullptr,
                                   normal);
    take_masters_at_ends(of, owns, normal, common.of_master);
  } else {
    take_normals(nodes, options.normals);
  }
  for (const auto& [i, of_master] : on_own_)
    if (state[i] == State::kept && on_master(i, pair[i])) state[i] = State::shared;
  for (std::size_t i = 0; i < nodes.taken.size(); ++i)
    if (nodes.taken[i] && state[i] == State::kept) state[i] = State::taken;
  if (!nodes.held.empty()) remove_held(of, undeformed_normals(of, options, owns, normal));
  if (begun) take_off_slaves(of);
  for (std::size_t p = 0; p < of.slaves.size(); ++p)
    choose_carriers(static_cast<Index>(p), of.slaves[p], of.covers[p],
                    begun ? &*begun->ownership : nullptr);
  break_rings(of);
}

void Ownership::rank_patches(const Sides& of) {
  owner.assign(of.nodes.X.size(), -1);
  pair.assign(of.nodes.X.size(), -1);
  covered.assign(of.nodes.X.size(), 0);
  std::vector<Patch> ranked;
  for (std::size_t p = 0; p < of.slaves.size(); ++p) {
    const Side& slave = of.slaves[p];
    Groups groups(slave.facets());
    const std::set<Corner> beyond =
        beyond_steps(slave, of.masters[p], of.nodes.X, of.covers[p].cells);
    const auto parted = [&](const Joint& joint) {
      const auto [f, g] = joint.facet;
      return std::any_of(joint.vertex.begin(), joint.vertex.end(), [&](Index i) {
        return beyond.count({f, i}) != beyond.count({g, i});
      });
    };
    for (const Joint& joint : slave.joints)
      if (joint.goes_on && !parted(joint)) groups.join(joint.facet[0], joint.facet[1]);
    std::map<Index, Patch> of_root;
    for (Index f = 0; f < slave.facets(); ++f) {
      Patch& patch = of_root[groups.of(f)];
      patch.pair = static_cast<Index>(p);
      patch.facets.push_back(f);
      patch.label = std::min(patch.label, label_position(slave.surface, slave.facet(f).label));
      patch.uncovered -= of.covers[p].fraction[f] * slave.planes[f].measure;
    }
    for (auto& entry : of_root) ranked.push_back(std::move(entry.second));
    rank.emplace_back(slave.facets());
    faced.emplace_back(of.masters[p].facets(), 0);
    for (const std::vector<Cell>& cells : of.covers[p].cells)
      for (const Cell& cell : cells) faced[p][cell.master] = 1;
  }
  std::sort(ranked.begin(), ranked.end());
  patches = static_cast<Index>(ranked.size());
  for (Index k = 0; k < patches; ++k)
    for (Index f : ranked[k].facets) rank[ranked[k].pair][f] = k;
}

void Ownership::own(const Sides& of, const Ways* ways) {
  const std::vector<Index> decided = owner;
  for_each_covered(of, [&](std::size_t p, Index f, Index i) {
    state[i] = State::kept;
    if (decided[i] >= 0 || (owner[i] >= 0 && owner[i] <= rank[p][f])) return;
    if (ways && ways->farther(p, f, i) > equally_near) return;
    owner[i] = rank[p][f];
    pair[i] = static_cast<Index>(p);
  });
  for_each_vertex(of.masters, [&](std::size_t p, Index f, Index i) {
    const Index of_master = static_cast<Index>(p);
    if (state[i] != State::kept) return;
    on_own_.insert({i, of_master});
    if (faced[p][f]) on_faced_.emplace(i, of_master);
  });
  const Carries carries = [&](std::size_t p, Index f, Index i) {
    return can_press(of.nodes, i, of.slaves[p].planes[f].normal) &&
           !on_master(i, static_cast<Index>(p));
  };
  if (ways) spare(of, *ways, carries, *this);
  for (std::size_t p = 0; p < of.slaves.size(); ++p)
    for (Index f = 0; f < of.slaves[p].facets(); ++f)
      for (const Cell& cell : of.covers[p].cells[f]) {
        const Vec3 lambda = slave_coordinates(of.nodes.dimension, centroid(cell.part));
        const Real measure = extent(cell.part) * of.slaves[p].planes[f].measure;
        for (int v = 0; v < of.nodes.dimension; ++v) {
          const Index i = of.slaves[p].facet(f).node[v];
          if (decided[i] < 0 && owner[i] == rank[p][f]) covered[i] += measure * lambda[v];
        }
      }
}

void Ownership::set_labels(const std::vector<Side>& slaves) {
  std::vector<Index> first(owner.size(), std::numeric_limits<Index>::max());
  for_each_vertex(slaves, [&](std::size_t p, Index f, Index i) {
    if (owner[i] != rank[p][f]) return;
    const long of_facet = slaves[p].facet(f).label;
    const Index at = label_position(slaves[p].surface, of_facet);
    if (at >= first[i]) return;
    first[i] = at;
    label[i] = of_facet;
  });
}

/// Given normals are asked for where something faces the slave, and leave it there.
void Ownership::take_normals(const Nodes& nodes, const std::vector<Vec3>& normals) {
  const int d = nodes.dimension;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (state[i] == State::uncovered) continue;
    const Vec3 given = normals[i].normalized(), outward = normal[i];
    const std::string at = place(d, nodes.X[i]) + " on label " + std::to_string(label[i]);
    if (!(given.norm() > 0))
      refuse("normal has no direction at ", at,
             "; give the outward normal of the slave, of any length > 0");
    if (!(given.dot(outward) > 0))
      refuse("normal = ", place(d, given), " at ", at,
             " points into the slave, whose boundary has the outward normal ", place(d, outward),
             "; give the normal that leaves the slave");
    normal[i] = given;
  }
}

bool Ownership::on_master(Index i, Index p) const {
  const auto first = on_faced_.find(i);
  return on_own_.count({i, p}) > 0 || (first != on_faced_.end() && first->second < p);
}

void Ownership::take_off_slaves(Sides& of) const {
  const int d = of.nodes.dimension;
  for (std::size_t p = 0; p < of.masters.size(); ++p)
    for (Index f = 0; f < of.slaves[p].facets(); ++f) {
      std::vector<Cell>& cells = of.covers[p].cells[f];
      const auto is_slave = [&](const Cell& cell) {
        const Facet& facet = of.masters[p].facet(cell.master);
        return std::any_of(facet.node.begin(), facet.node.begin() + d, [&](Index i) {
          return state[i] == State::kept && pair[i] > static_cast<Index>(p);
        });
      };
      for (const Cell& cell : cells)
        if (is_slave(cell))
          of.covers[p].fraction[f] -= extent(cell.part) / extent(reference_facet(d));
      cells.erase(std::remove_if(cells.begin(), cells.end(), is_slave), cells.end());
    }
}

void Ownership::remove_held(const Sides& of, const std::vector<Vec3>& deciding) {
  const Nodes& nodes = of.nodes;
  for (std::size_t i = 0; i < owner.size(); ++i) {
    if (state[i] != State::kept || nodes.held[i] == 0) continue;
    const Index node = static_cast<Index>(i);
    const Vec3 free = normal[i] - held_part(nodes, node, normal[i]);
    if (held_part(nodes, node, deciding[i]).norm() > mostly_free || free.norm() <= mostly_free)
      state[i] = State::held;
    else
      normal[i] = free.normalized();
  }
  // A held mid-edge between ends that are free would tie them to itself.
  for (const Side& slave : of.slaves)
    for (const Facet& facet : slave.surface.facets)
      for (int k = 0; slave.surface.quadratic && k < edges_of_facet(slave.d); ++k)
        for (int end : edge_ends(slave.d, k)) {
          const Index e = facet.node[slave.d + k], i = facet.node[end];
          if ((nodes.held[e] & ~nodes.held[i]) != 0 && state[i] == State::kept)
            state[i] = State::held;
        }
}

bool Ownership::slips(Index p) const {
  return std::any_of(slipping.begin(), slipping.end(), [p](const auto& of_body) {
    return of_body.first[0] == p && of_body.second > 0;
  });
}

void Ownership::choose_carriers(Index p, const Side& slave, const Cover& cover,
                                const Ownership* begun) {
  carriers.emplace_back(slave.facets());
  std::vector<char> has_own(patches, 0);
  for (Index f = 0; f < slave.facets(); ++f) {
    std::array<bool, 3>& kept = carriers[p][f].kept;
    for (int v = 0; v < slave.d && !cover.cells[f].empty(); ++v) {
      const Index i = slave.facet(f).node[v];
      kept[v] = state[i] == State::kept && owner[i] == rank[p][f];
    }
    if (!carriers[p][f].any_kept()) continue;
    has_own[rank[p][f]] = 1;
  }
  const bool at_node = !slave.is_moved && slips(p);
  find_beyond(p, slave, cover, begun);
  if (begun) put_off(p, slave, cover, begun->carriers[p]);
  for (Index f = 0; f < slave.facets(); ++f) {
    Carriers& of = carriers[p][f];
    if (!of.any_kept()) continue;
    const auto keeps = [&](int v) {
      return begun && of.beyond(v) && begun->carriers[p][f].kept[v];
    };
    const bool any_keeps = keeps(0) || keeps(1) || keeps(2);
    const Real part = cover.fraction[f] / (any_keeps ? barely_kept : barely);
    thin_out(slave.facet(f), part, of);
    of.at_node = part < 2 && at_node;
  }
  find_stand_ins(p, slave, true);
  // A patch without nodes of its own leaves its traction to the nodes it shares with others.
  for (Index f = 0; f < slave.facets(); ++f) {
    if (cover.cells[f].empty() || has_own[rank[p][f]]) continue;
    for (int v = 0; v < slave.d; ++v)
      carriers[p][f].kept[v] = state[slave.facet(f).node[v]] == State::kept;
    thin_out(slave.facet(f), 2, carriers[p][f]);  // to know the strongest
  }
  find_stand_ins(p, slave, false);
}

/// A law at a vertex that nothing faces would be that of a surface which goes on where it has
/// ended: a body would stand on it up to a facet beyond its edge. Round faces that let motions slip
/// keep it: between vertices their normals are not known so well.
///
/// Which laws lean on which does not jump within an increment: a vertex with a law where that began
/// counts as faced only if it was so there, and less and less as its facets are left.
void Ownership::find_beyond(Index p, const Side& slave, const Cover& cover,
                            const Ownership* begun) {
  constexpr Real at_vertex = 1 - 1e-6, fading = 0.2;  // of a facet
  reached_.resize(state.size(), 0);
  if (slips(p)) return;
  const auto for_each_point = [&](Index f, const auto& visit) {
    for (const Cell& cell : cover.cells[f])
      for (const Vec2& xi : cell.part) visit(slave_coordinates(slave.d, xi));
  };
  for (Index f = 0; f < slave.facets(); ++f)
    for_each_point(f, [&](const Vec3& lambda) {
      for (int v = 0; v < slave.d; ++v) {
        const Index i = slave.facet(f).node[v];
        if (!carriers[p][f].kept[v]) continue;
        const bool touched = common.of_master[i] || lambda[v] > at_vertex;
        reached_[i] = touched ? 1 : std::max(reached_[i], 1 - (1 - lambda[v]) / fading);
      }
    });
  for (Index f = 0; f < slave.facets(); ++f) {
    Carriers& of = carriers[p][f];
    Vec3 now = Vec3::Zero(), kept_up = Vec3::Zero();
    bool was_faced = false;
    for (int v = 0; v < slave.d; ++v) {
      const Index i = slave.facet(f).node[v];
      if (!of.kept[v]) continue;
      now[v] = kept_up[v] = reached_[i] == 1;
      if (!begun || !begun->carriers[p][f].kept[v]) continue;
      kept_up[v] = begun->reached_[i] == 1 ? reached_[i] : 0;
      was_faced = was_faced || begun->reached_[i] == 1;
    }
    if (was_faced || !kept_up.isZero(0)) now = kept_up;
    of.reach = now;
    for_each_point(f, [&](const Vec3& lambda) { of.reach = of.reach.cwiseMax(lambda); });
    if (now.isZero(0)) continue;
    for (int v = 0; v < 3; ++v)
      if (of.kept[v]) of.reached[v] = now[v];
  }
}

/// Nodes beyond that have begun without a law have none where less than for_a_law is covered of
/// each facet around them.
void Ownership::put_off(Index p, const Side& slave, const Cover& cover,
                        const std::vector<Carriers>& begun) {
  std::map<Index, Real> most;
  const auto for_each_vertex_of = [&](Index f, const auto& visit) {
    for (int v = 0; v < slave.d; ++v) visit(v, slave.facet(f).node[v], carriers[p][f]);
  };
  for (Index f = 0; f < slave.facets(); ++f)
    for_each_vertex_of(f, [&](int v, Index i, const Carriers& of) {
      const Real part = begun[f].kept[v] ? 1 : cover.fraction[f];
      if (of.beyond(v)) most[i] = std::max(most[i], part);
    });
  for (Index f = 0; f < slave.facets(); ++f)
    for_each_vertex_of(f, [&](int v, Index i, Carriers& of) {
      const auto at = most.find(i);
      if (at == most.end() || at->second >= for_a_law) return;
      of.kept[v] = false;
      of.reached[v] = 1;
      state[i] = State::uncovered;
    });
}

/// No law is extrapolated from a sliver: of its kept vertices the one before which most is
/// covered, by lambda_i, stands for all, and among equals that of the highest number. Such an order
/// has no circle, so that removed nodes cannot depend on each other in one.
void Ownership::thin_out(const Facet& facet, Real part, Carriers& of_facet) const {
  const Real alone = std::clamp<Real>(2 - part, 0, 1);
  int most = -1;
  const auto strength = [&](int v) {
    return std::make_pair(covered[facet.node[v]], facet.node[v]);
  };
  for (int v = 0; v < 3; ++v)
    if (of_facet.kept[v] && (most < 0 || strength(most) < strength(v))) most = v;
  of_facet.strongest = {most == 0, most == 1, most == 2};
  if (alone < 1)
    of_facet.alone = alone;
  else
    of_facet.kept = of_facet.strongest;
}

/// A facet without carriers gets those of the nearest facet that has some, found breadth first over
/// the ridges: within its own patch, or anywhere.
void Ownership::find_stand_ins(Index p, const Side& slave, bool within_patch) {
  std::vector<std::vector<Index>> neighbours(slave.facets());
  for (const Joint& joint : slave.joints) {
    const auto [f, g] = joint.facet;
    if (within_patch && rank[p][f] != rank[p][g]) continue;
    neighbours[f].push_back(g);
    neighbours[g].push_back(f);
  }
  const auto carried = [&](Index f) {
    const Carriers& c = carriers[p][f];
    return c.any_kept() || !c.stand_in.empty();
  };
  std::vector<Index> queue;
  for (Index f = 0; f < slave.facets(); ++f)
    if (carried(f)) queue.push_back(f);
  for (std::size_t k = 0; k < queue.size(); ++k)
    for (Index g : neighbours[queue[k]]) {
      if (carried(g)) continue;
      const Carriers& from = carriers[p][queue[k]];
      std::vector<Index> stand_in = from.stand_in;
      for (int v = 0; v < slave.d; ++v)
        if (from.kept[v]) stand_in.push_back(slave.facet(queue[k]).node[v]);
      carriers[p][g].stand_in = std::move(stand_in);
      queue.push_back(g);
    }
}

Arrangement::Arrangement(const Nodes& nodes_, std::vector<Pair> parted, const Options& options,
                         const Arrangement* begun)
    : Sides{nodes_}, pairs(std::move(parted)) {
  if (begun) choices = begun->choices;
  if (!begun) validate_pairs(nodes, pairs, options);
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    slaves.emplace_back(nodes.dimension, pairs[p].slave, nodes.X, nodes.reference);
    masters.emplace_back(nodes.dimension, pairs[p].master, nodes.X, nodes.reference);
    std::optional<Earlier> earlier;
    if (begun) earlier.emplace(Earlier{begun->slaves[p], begun->masters[p], begun->nodes.X});
    covers.push_back(cover(nodes, pairs[p].itself, slaves[p], masters[p], options.maxgap, earlier));
  }
  ownership.emplace(*this, options, begun);
}

}  // namespace frictioncg::mortar
