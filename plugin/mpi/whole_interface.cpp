#include "whole_interface.h"

namespace frictioncg {

namespace {

Vector as_vector(const std::vector<Real>& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

}  // namespace

WholeInterface::WholeInterface(const Domain& domain, const NodeNumbers& numbers, Index dimension,
                               const InterfacePart& part)
    : d(dimension), pairs(part.pairs) {
  for (mortar::Pair& pair : pairs)
    for (mortar::Surface* side : {&pair.slave, &pair.master}) side->facets.clear();
  gather_nodes(domain, numbers, part);
  gather_facets(domain, numbers, part);
  find_one_body();
  find_own(domain, numbers);
}

/// Slaves and others, one gather each.
void WholeInterface::gather_nodes(const Domain& domain, const NodeNumbers& numbers,
                                  const InterfacePart& part) {
  const Index all = static_cast<Index>(part.X.size());
  const auto gather = [&](Index first, Index end) {
    std::vector<Real> own;
    for (Index i = first; i < end; ++i) {
      if (!domain.owns(part.dof[i][0])) continue;
      const Vec3& x = part.X[i];
      const auto number_of_node = numbers.node(numbers.of(part.dof[i][0]));
      own.insert(own.end(), {Real(number_of_node), x[0], x[1], x[2], Real(part.held[i]),
                             Real(part.body[i]), Real(part.groups[i])});
      const Motion& moved = part.motion;
      if (part.is_moved)
        for (const auto* of : {&moved.now, &moved.before, &moved.force})
          own.insert(own.end(), (*of)[i].data(), (*of)[i].data() + 3);
      if (i >= part.slaves) continue;
      own_slaves_.push_back(i);
      own.insert(own.end(), part.options[i].begin(), part.options[i].end());
    }
    return domain.gathered(as_vector(own));
  };
  const Index more =
      static_cast<Index>(domain.largest(part.options.empty() ? 0 : part.options.front().size()));
  const auto add = [&](const Vector& sent, Index extra) {
    for (const Real* in = sent.data(); in != sent.data() + sent.size();) {
      number.push_back(static_cast<NodeNumbers::Number>(*in++));
      at.emplace(number.back(), nodes() - 1);
      X.emplace_back(in[0], in[1], in[2]);
      held.push_back(static_cast<unsigned char>(in[3]));
      body.push_back(static_cast<Index>(in[4]));
      groups.push_back(static_cast<Index>(in[5]));
      in += 6;
      if (part.is_moved)
        for (auto* of : {&motion.now, &motion.before, &motion.force}) {
          of->emplace_back(in[0], in[1], in[2]);
          in += 3;
        }
      if (extra > 0) options.emplace_back(in, in + extra);
      in += extra;
    }
  };
  add(gather(0, part.slaves), more);
  add(gather(part.slaves, all), 0);
}

void WholeInterface::gather_facets(const Domain& domain, const NodeNumbers& numbers,
                                   const InterfacePart& part) {
  std::vector<Real> own;
  const auto number_at = [&](Index i) { return numbers.node(numbers.of(part.dof[i][0])); };
  for (std::size_t p = 0; p < part.pairs.size(); ++p)
    for (int side = 0; side < 2; ++side) {
      const mortar::Surface& surface = side == 0 ? part.pairs[p].slave : part.pairs[p].master;
      const int count = mortar::nodes_of_facet(d, surface.quadratic);
      for (const mortar::Facet& f : surface.facets) {
        Index first = f.node[0];
        for (int v = 1; v < d; ++v)
          if (number_at(f.node[v]) < number_at(first)) first = f.node[v];
        if (!domain.owns(part.dof[first][0])) continue;
        own.insert(own.end(),
                   {Real(p), Real(side), Real(f.label), f.outward[0], f.outward[1], f.outward[2],
                    f.behind < 0 ? -1 : Real(number_at(f.behind)), f.thickness, Real(count)});
        for (int k = 0; k < count; ++k) own.push_back(Real(number_at(f.node[k])));
      }
    }
  const Vector sent = domain.gathered(as_vector(own));
  const auto node = [&](Real numbered) {
    return at.at(static_cast<NodeNumbers::Number>(numbered));
  };
  for (const Real* in = sent.data(); in != sent.data() + sent.size();) {
    mortar::Pair& pair = pairs[static_cast<std::size_t>(in[0])];
    mortar::Surface& surface = in[1] == 0 ? pair.slave : pair.master;
    mortar::Facet f;
    f.label = static_cast<long>(in[2]);
    f.outward = {in[3], in[4], in[5]};
    if (in[6] >= 0) f.behind = node(in[6]);
    f.thickness = in[7];
    const int count = static_cast<int>(in[8]);
    in += 9;
    surface.quadratic = count > d;
    for (int k = 0; k < count; ++k) f.node[k] = node(*in++);
    surface.facets.push_back(f);
  }
}

/// A part does not know which facets are of one body.
void WholeInterface::find_one_body() {
  for (mortar::Pair& pair : pairs) {
    for (mortar::Surface* side : {&pair.slave, &pair.master})
      for (mortar::Facet& f : side->facets) f.body = body[f.node[0]];
    std::set<Index> of_slave;
    for (const mortar::Facet& f : pair.slave.facets) of_slave.insert(f.body);
    for (mortar::Facet& f : pair.master.facets) f.one_body = of_slave.count(f.body) > 0;
  }
}

/// Of the nodes that facets name: one process has no others.
void WholeInterface::find_own(const Domain& domain, const NodeNumbers& numbers) {
  own_dof_.assign(number.size(), -1);
  const auto add = [&](Index i) {
    if (i >= 0 && numbers.owner(number[i]) == domain.rank())
      own_dof_[i] = numbers.dof(number[i], 0);
  };
  for (const mortar::Pair& pair : pairs)
    for (const mortar::Surface* side : {&pair.slave, &pair.master})
      for (const mortar::Facet& f : side->facets) {
        std::for_each(f.node.begin(), f.node.end(), add);
        add(f.behind);
      }
}

Vector WholeInterface::gathered(const Domain& domain, const Vector& at_part) const {
  Vector own(static_cast<Index>(own_slaves_.size()));
  for (Index k = 0; k < own.size(); ++k) own[k] = at_part[own_slaves_[k]];
  return domain.gathered(own);
}

std::vector<Vec3> WholeInterface::at_nodes(const Domain& domain, const Vector& u) const {
  std::vector<Vec3> of_node(number.size(), Vec3::Zero());
  for (Index i = 0; i < nodes(); ++i)
    for (Index c = 0; c < d && own_dof_[i] >= 0; ++c) of_node[i][c] = u[own_dof_[i] + c];
  domain.sum(of_node.front().data(), 3 * nodes());
  return of_node;
}

Vector WholeInterface::on_free_dofs(const std::vector<Vec3>& of_node, Index n) const {
  Vector of_dof = Vector::Zero(n);
  for (Index i = 0; i < nodes(); ++i)
    for (Index c = 0; c < d && own_dof_[i] >= 0; ++c)
      if ((held[i] >> c & 1) == 0) of_dof[own_dof_[i] + c] = of_node[i][c];
  return of_dof;
}

}  // namespace frictioncg
