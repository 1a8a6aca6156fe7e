#include "assembly/mortar/slip.h"

#include <unordered_map>

#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

namespace {

/// (G x)_k, seen from node i: the entries of a row sum up to 0.
Vec3 relative(const Matrix& G, Index k, Index i, const std::vector<Vec3>& x) {
  Vec3 sum = Vec3::Zero();
  for (Matrix::InnerIterator it(G, k); it; ++it) sum += it.value() * (x[it.col()] - x[i]);
  return sum;
}

}  // namespace

std::vector<Vec3> slip_beside(const Mortar& now, const std::vector<Vec3>& x, const Mortar& old,
                              const std::vector<Vec3>& x_old) {
  std::unordered_map<Index, Index> row_of;  // of a node in G_old
  for (const ContactNode& node : old.nodes())
    row_of.emplace(node.node, static_cast<Index>(row_of.size()));
  std::vector<Vec3> c;
  for (const ContactNode& node : now.nodes()) {
    const Index k = static_cast<Index>(c.size()), i = node.node;
    c.push_back(Vec3::Zero());
    const auto before = row_of.find(i);
    if (before == row_of.end()) continue;
    const Matrix& G = now.relative();
    const Vec3 sum = relative(old.relative(), before->second, i, x) - 2 * relative(G, k, i, x) +
                     relative(G, k, i, x_old);
    c[k] = sum / G.coeff(k, i);
  }
  return c;
}

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

std::vector<Pair> carried(int d, std::vector<Pair> pairs, const std::vector<Vec3>& X,
                          const std::vector<Vec3>& Y) {
  for (Pair& pair : pairs)
    for (Surface* surface : {&pair.slave, &pair.master}) {
      std::vector<Plane> planes;
      for (const Facet& f : surface->facets) planes.push_back(plane_of(d, f, X));
      planes = planes_at(d, *surface, planes, X, Y);
      for (std::size_t f = 0; f < planes.size(); ++f) surface->facets[f].outward = planes[f].normal;
    }
  return pairs;
}

}  // namespace frictioncg::mortar
