#include "assembly/mortar/surface.h"

namespace frictioncg::mortar {

std::string place(int d, const Vec3& x) {
  std::ostringstream s;
  s << "(" << x[0] << ", " << x[1];
  if (d == 3) s << ", " << x[2];
  s << ")";
  return s.str();
}

std::string labels_of(const Surface& surface) {
  std::ostringstream s;
  s << (surface.labels.size() > 1 ? "labels" : "label");
  for (std::size_t k = 0; k < surface.labels.size(); ++k)
    s << (k > 0 ? ", " : " ") << surface.labels[k];
  return s.str();
}

Shape shape_functions(int d, bool quadratic, const Vec3& lambda) {
  Shape phi{};
  for (int v = 0; v < d; ++v) phi[v] = lambda[v];
  if (!quadratic) return phi;
  for (int v = 0; v < d; ++v) phi[v] = lambda[v] * (2 * lambda[v] - 1);
  for (int k = 0; k < edges_of_facet(d); ++k) {
    const auto [a, b] = edge_ends(d, k);
    phi[d + k] = 4 * lambda[a] * lambda[b];
  }
  return phi;
}

namespace {

/// A triangle whose area is below this share of the square of its longest edge is a segment.
constexpr Real degenerate = 1e-14;

[[noreturn]] void refuse_flat(const Facet& facet, const Vec3& at) {
  refuse("a facet of label ", facet.label, " at ", place(3, at), " has no extent");
}

}  // namespace

Vec3 centre_of(int d, const Facet& facet, const std::vector<Vec3>& X) {
  Vec3 centre = Vec3::Zero();
  for (int v = 0; v < d; ++v) centre += X[facet.node[v]] / d;
  return centre;
}

Plane plane_of(int d, const Facet& facet, const std::vector<Vec3>& X) {
  Plane p;
  p.origin = X[facet.node[0]];
  const Vec3 e1 = X[facet.node[1]] - p.origin;
  if (d == 2) {
    p.size = p.measure = e1.norm();
    if (!(p.measure > 0)) refuse_flat(facet, p.origin);
    p.normal = Vec3(e1[1], -e1[0], 0) / p.measure;
    p.B.row(0) = e1.transpose() / e1.squaredNorm();
  } else {
    const Vec3 e2 = X[facet.node[2]] - p.origin;
    const Vec3 n = e1.cross(e2);
    p.size = std::max({e1.norm(), e2.norm(), (e2 - e1).norm()});
    if (!(n.norm() > degenerate * p.size * p.size)) refuse_flat(facet, p.origin);
    p.measure = n.norm() / 2;
    p.normal = n.normalized();
    p.B.row(0) = e2.cross(n).transpose() / n.squaredNorm();
    p.B.row(1) = n.cross(e1).transpose() / n.squaredNorm();
  }
  if (p.normal.dot(facet.outward) < 0) p.normal = -p.normal;
  return p;
}

std::vector<Pair> label_pairs(const std::vector<long>& slave, const std::vector<long>& master,
                              bool in_one_space) {
  if (slave.size() != master.size() && slave.size() != 1 && master.size() != 1)
    refuse(
        "slave has ", slave.size(), " labels and master has ", master.size(),
        "; lists of one length are pairs, slave[k] facing master[k], and a single label faces all "
        "of the other list");
  if (in_one_space && slave == master) return {{{false, slave, {}}, {false, master, {}}, false, 0}};
  const std::size_t count = std::max(slave.size(), master.size());
  std::vector<Pair> of_slave;  // one slave label each
  for (std::size_t k = 0; k < count; ++k) {
    const long s = slave[slave.size() > 1 ? k : 0], m = master[master.size() > 1 ? k : 0];
    auto at = std::find_if(of_slave.begin(), of_slave.end(),
                           [s](const Pair& p) { return p.slave.labels.front() == s; });
    if (at == of_slave.end()) {
      at = of_slave.insert(at, Pair());
      at->slave.labels = {s};
    }
    std::vector<long>& masters = at->master.labels;
    if (std::count(masters.begin(), masters.end(), m) == 0) masters.push_back(m);
  }
  std::vector<Pair> pairs;
  for (const Pair& one : of_slave) {
    const std::vector<long>& masters = one.master.labels;
    const auto at = std::find_if(pairs.begin(), pairs.end(), [&masters](const Pair& p) {
      return std::is_permutation(p.master.labels.begin(), p.master.labels.end(), masters.begin(),
                                 masters.end());
    });
    if (at == pairs.end())
      pairs.push_back(one);
    else
      at->slave.labels.push_back(one.slave.labels.front());
  }
  return pairs;
}

}  // namespace frictioncg::mortar
