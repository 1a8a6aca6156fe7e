#include "whole_interface.h"

namespace frictioncg {

WholeInterface::WholeInterface(const Domain& domain, const NodeNumbers& numbers,
                               const Interface& part, const std::vector<InterfaceNode>& of_part)
    : d(part.d), pairs(part.pairs) {
  for (mortar::Pair& pair : pairs)
    for (mortar::Surface* side : {&pair.slave, &pair.master}) side->facets.clear();
  gather_nodes(domain, numbers, part, of_part);
  gather_facets(domain, numbers, part);
  find_one_body();
  find_own(domain, numbers);
}

/// Slaves and others, one gather each.
void WholeInterface::gather_nodes(const Domain& domain, const NodeNumbers& numbers,
                                  const Interface& part,
                                  const std::vector<InterfaceNode>& of_part) {
  const Index slaves_here = static_cast<Index>(part.slave.size());
  const auto gathered = [&](Index first, Index end) {
    std::vector<InterfaceNode> own;
    for (Index i = first; i < end; ++i) {
      if (!domain.owns(part.dof[i][0])) continue;
      own.push_back(of_part[i]);
      own.back().number = numbers.node(numbers.of(part.dof[i][0]));
    }
    return domain.gathered(own);
  };
  nodes = gathered(0, slaves_here);
  slaves = count();
  const auto others = gathered(slaves_here, static_cast<Index>(of_part.size()));
  nodes.insert(nodes.end(), others.begin(), others.end());
  for (Index i = 0; i < count(); ++i) at.emplace(nodes[i].number, i);
  for (Index i = 0; i < slaves_here; ++i)
    own_slaves_.push_back(
        domain.owns(part.dof[i][0]) ? at.at(numbers.node(numbers.of(part.dof[i][0]))) : -1);
}

void WholeInterface::gather_facets(const Domain& domain, const NodeNumbers& numbers,
                                   const Interface& part) {
  using Number = NodeNumbers::Number;
  struct Sent {
    std::size_t pair;
    bool of_master, quadratic;
    mortar::Facet facet;
    std::array<Number, 6> node;  ///< of which the facet has the places on one process
    Number behind;
  };
  const auto number_at = [&](Index i) {
    return i < 0 ? -1 : numbers.node(numbers.of(part.dof[i][0]));
  };
  std::vector<Sent> own;
  for (std::size_t p = 0; p < part.pairs.size(); ++p)
    for (const bool of_master : {false, true}) {
      const mortar::Surface& surface = of_master ? part.pairs[p].master : part.pairs[p].slave;
      for (const mortar::Facet& f : surface.facets) {
        const Index first =
            *std::min_element(f.node.begin(), f.node.begin() + d,
                              [&](Index i, Index j) { return number_at(i) < number_at(j); });
        if (!domain.owns(part.dof[first][0])) continue;
        Sent& sent =
            own.emplace_back(Sent{p, of_master, surface.quadratic, f, {}, number_at(f.behind)});
        std::transform(f.node.begin(), f.node.end(), sent.node.begin(), number_at);
      }
    }
  const auto place_of = [&](Number number) { return number < 0 ? -1 : at.at(number); };
  for (Sent& sent : domain.gathered(own)) {
    mortar::Pair& pair = pairs[sent.pair];
    mortar::Surface& surface = sent.of_master ? pair.master : pair.slave;
    std::transform(sent.node.begin(), sent.node.end(), sent.facet.node.begin(), place_of);
    sent.facet.behind = place_of(sent.behind);
    surface.quadratic = sent.quadratic;
    surface.facets.push_back(sent.facet);
  }
}

/// A part does not know which facets are of one body.
void WholeInterface::find_one_body() {
  for (mortar::Pair& pair : pairs) {
    for (mortar::Surface* side : {&pair.slave, &pair.master})
      for (mortar::Facet& f : side->facets) f.body = nodes[f.node[0]].body;
    std::set<Index> of_slave;
    for (const mortar::Facet& f : pair.slave.facets) of_slave.insert(f.body);
    for (mortar::Facet& f : pair.master.facets) f.one_body = of_slave.count(f.body) > 0;
  }
}

/// Of the nodes that facets name: one process has no others.
void WholeInterface::find_own(const Domain& domain, const NodeNumbers& numbers) {
  own_dof_.assign(nodes.size(), -1);
  const auto add = [&](Index i) {
    if (i >= 0 && numbers.owner(nodes[i].number) == domain.rank())
      own_dof_[i] = numbers.dof(nodes[i].number, 0);
  };
  for (const mortar::Pair& pair : pairs)
    for (const mortar::Surface* side : {&pair.slave, &pair.master})
      for (const mortar::Facet& f : side->facets) {
        std::for_each(f.node.begin(), f.node.end(), add);
        add(f.behind);
      }
}

std::vector<mortar::NodeGap> WholeInterface::gathered(
    const Domain& domain, const std::vector<mortar::NodeGap>& of_part) const {
  std::vector<mortar::NodeGap> own;
  for (const mortar::NodeGap& g : of_part)
    if (const Index i = own_slaves_[g.node]; i >= 0) own.push_back({i, g.label, g.gap});
  return domain.gathered(own);
}

std::vector<Vec3> WholeInterface::at_nodes(const Domain& domain, const Vector& u) const {
  std::vector<Vec3> of_node(nodes.size(), Vec3::Zero());
  for (Index i = 0; i < count(); ++i)
    for (Index c = 0; c < d && own_dof_[i] >= 0; ++c) of_node[i][c] = u[own_dof_[i] + c];
  domain.sum(of_node.front().data(), 3 * count());
  return of_node;
}

Vector WholeInterface::on_free_dofs(const std::vector<Vec3>& of_node, Index n) const {
  Vector of_dof = Vector::Zero(n);
  for (Index i = 0; i < count(); ++i)
    for (Index c = 0; c < d && own_dof_[i] >= 0; ++c)
      if ((nodes[i].held >> c & 1) == 0) of_dof[own_dof_[i] + c] = of_node[i][c];
  return of_dof;
}

}  // namespace frictioncg
