#include "assembly/mortar/ownership.h"
#include "assembly/mortar/search.h"

namespace frictioncg::mortar {

namespace {

using Key = std::array<Index, 3>;

Key key(int d, const Facet& facet) {
  Key k{facet.node[0], facet.node[1], d == 3 ? facet.node[2] : -1};
  std::sort(k.begin(), k.end());
  return k;
}

void refuse_common_facets(int d, const std::vector<Pair>& pairs) {
  std::map<Key, const Pair*> slave;
  for (const Pair& pair : pairs)
    for (const Facet& f : pair.slave.facets)
      if (!slave.emplace(key(d, f), &pair).second)
        refuse("label ", f.label, " is slave twice; list it once");
  for (const Pair& pair : pairs)
    for (const Facet& f : pair.master.facets) {
      const auto found = slave.find(key(d, f));
      if (found != slave.end() && found->second == &pair) {
        refuse("label ", f.label,
               " is on both sides; a boundary is slave or master, or, where it touches itself, the "
               "one and the other by the same labels alone");
      }
    }
}

/// T expresses slave nodes by master nodes: facets that face something are to be no masters.
/// (Single nodes may be both: Ownership.)
void refuse_slaves_as_masters(const Sides& of) {
  const std::vector<Side>&slaves = of.slaves, &masters = of.masters;
  if (slaves.size() < 2) return;
  const int d = of.nodes.dimension;
  std::map<Key, std::size_t> facing;  // slave facets, and their pair
  for (std::size_t p = 0; p < slaves.size(); ++p)
    for (Index f = 0; f < slaves[p].facets(); ++f)
      if (!of.covers[p].cells[f].empty()) facing.emplace(key(d, slaves[p].facet(f)), p);
  for (std::size_t q = 0; q < masters.size(); ++q)
    for (const std::vector<Cell>& cells : of.covers[q].cells)
      for (const Cell& cell : cells) {
        const Facet& facet = masters[q].facet(cell.master);
        const auto found = facing.find(key(d, facet));
        if (found == facing.end()) continue;
        refuse("the node at ", place(d, of.nodes.X[facet.node[0]]), " on label ", facet.label,
               " is slave of one pair (master: ", labels_of(masters[found->second].surface),
               ") and master of another (slave: ", labels_of(slaves[q].surface),
               "); exchange slave and master of one of the two, leave out by maxgap what does not "
               "touch there, or, in one space, name all of the labels on both sides");
      }
}

void refuse_merged_nodes(const Nodes& nodes, const std::vector<Pair>& pairs,
                         const Options& options) {
  std::vector<char> is_slave(nodes.X.size(), 0);
  for (const Pair& pair : pairs)
    for (const Facet& f : pair.slave.facets)
      for (int v = 0; v < nodes.dimension; ++v) is_slave[f.node[v]] = 1;
  for (const Pair& pair : pairs)
    for (const Facet& f : pair.master.facets)
      for (int v = 0; v < nodes.dimension; ++v) {
        const Index i = f.node[v];
        if (!is_slave[i]) continue;
        is_slave[i] = 0;
        const Index groups = options.element_groups(i);
        if (groups < 2) continue;
        refuse("slave and master share the node at ", place(nodes.dimension, nodes.X[i]),
               ", where ", groups,
               " bodies meet: the meshes were merged there, as + does with near vertices; use one "
               "space per mesh, or join them apart and move them back with movemesh, in 3D with "
               "cleanmesh=false");
      }
}

/// Where the weight vanishes on a whole facet nothing is integrated, and its nodes have no share.
void refuse_weightless(const Nodes& nodes, const Side& slave, const Cover& cover,
                       const std::vector<Real>& weight) {
  for (Index f = 0; f < slave.facets(); ++f) {
    if (cover.cells[f].empty()) continue;
    const Facet& facet = slave.facet(f);
    Real sum = 0;
    for (int v = 0; v < slave.d; ++v) sum += weight[facet.node[v]];
    if (sum > 0) continue;
    refuse("weight = 0 on a whole facet of label ", facet.label, ", at ",
           place(slave.d, nodes.X[facet.node[0]]),
           ", which faces the master; a weight is > 0 but on the axis, where no facet lies");
  }
}

/// Whether nothing is yet before a node that no obstacle takes and whose normal no Dirichlet
/// condition holds: bodies that move may bring it something.
bool may_carry_later(const Arrangement& of, const Side& slave) {
  if (of.nodes.reference.empty()) return false;  // nothing moves
  for (Index f = 0; f < slave.facets(); ++f)
    for (int v = 0; v < slave.d; ++v) {
      const Index i = slave.facet(f).node[v];
      if (of.ownership->state[i] == Ownership::State::uncovered &&
          can_press(of.nodes, i, slave.planes[f].normal))
        return true;
    }
  return false;
}

[[noreturn]] void refuse_nothing_faces(const Nodes& nodes, const Side& slave, const Side& master,
                                       const Cover& cover, const Options& options) {
  const std::string nothing = "nothing on the master (" + labels_of(master.surface) +
                              ") faces the slave (" + labels_of(slave.surface) + ")";
  Real nearest = infinity;
  if (cover.nearest < nearest)
    refuse(nothing, " within maxgap = ", options.maxgap, "; the nearest opposite facet is ",
           cover.nearest, " away");
  const FacetTree tree(slave.d, master.surface.facets, master.planes, nodes.X);
  for (const Facet& f : slave.surface.facets)
    for (int v = 0; v < slave.d; ++v) nearest = std::min(nearest, tree.nearest(nodes.X[f.node[v]]));
  refuse(nothing, ": no facet lies opposite, along the normals of the slave, and the surfaces are ",
         nearest, " apart; check the labels and the orientation");
}

}  // namespace

void validate_pairs(const Nodes& nodes, const std::vector<Pair>& pairs, const Options& options) {
  if (!(options.maxgap > 0)) refuse("maxgap = ", options.maxgap, "; it must be > 0");
  refuse_common_facets(nodes.dimension, pairs);
  if (options.element_groups) refuse_merged_nodes(nodes, pairs, options);
}

void validate_cover(const Arrangement& of, const Options& options) {
  const Nodes& nodes = of.nodes;
  const std::vector<Side>& slaves = of.slaves;
  refuse_slaves_as_masters(of);
  std::set<Ownership::State> states;  // of all parts of a pair that touches itself
  bool waits = false;
  for (std::size_t p = 0; p < slaves.size(); ++p) {
    const Cover& cover = of.covers[p];
    const auto is_empty = [](const std::vector<Cell>& cells) { return cells.empty(); };
    const bool faces_nothing = std::all_of(cover.cells.begin(), cover.cells.end(), is_empty);
    if (faces_nothing && nodes.reference.empty() && !of.pairs[p].itself)
      refuse_nothing_faces(nodes, slaves[p], of.masters[p], cover, options);
    if (!options.weight.empty()) refuse_weightless(nodes, slaves[p], cover, options.weight);
    for (Index f = 0; f < slaves[p].facets(); ++f)
      for (int v = 0; v < slaves[p].d && !cover.cells[f].empty(); ++v)
        states.insert(of.ownership->state[slaves[p].facet(f).node[v]]);
    waits = waits || may_carry_later(of, slaves[p]);
    if (p + 1 < slaves.size() && of.pairs[p + 1].given == of.pairs[p].given) continue;
    const std::set<Ownership::State> all = std::exchange(states, {});
    const auto some = [&](Ownership::State state) { return all.count(state) > 0; };
    // bodies that move may come apart
    if (std::exchange(waits, false) || all.empty() || some(Ownership::State::kept)) continue;
    const bool others = std::any_of(cover.cells.begin(), cover.cells.end(), is_empty);
    const std::string labels = "every slave node (" + labels_of(slaves[p].surface) + ")" +
                               (others ? " that faces the master" : "");
    if (some(Ownership::State::held))
      refuse("Dirichlet conditions hold the normal of ", labels, "; swap slave and master");
    const bool shared = some(Ownership::State::shared);
    if (some(Ownership::State::taken))
      refuse(labels, " lies on the obstacle too, which it obeys",
             shared ? ", or on a master; refine the slave"
                    : "; refine the slave, or swap slave and master");
    refuse(labels, " lies on a master too; refine the slave");
  }
}

}  // namespace frictioncg::mortar
