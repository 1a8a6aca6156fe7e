#include "assembly/mortar/across_gap.h"

#include <algorithm>

#include "linear_algebra.h"

namespace frictioncg::mortar {

namespace {

/// Weights move by up to `narrow` of a barycentric coordinate, which is about the gap over the
/// height of the element; what asks for more fades out towards `widest`.
constexpr Real narrow = 0.1, widest = 0.15;

/// The vertices of the element behind a facet.
std::vector<Index> element_of(const Facet& facet, int d) {
  std::vector<Index> vertices(facet.node.begin(), facet.node.begin() + d);
  vertices.push_back(facet.behind);
  return vertices;
}

/// grad lambda_l . e of the vertices of a simplex: their sum is 0, and that of times X_l is e.
Eigen::VectorXd shift(const std::vector<Index>& vertices, const std::vector<Vec3>& X,
                      const Vec3& e) {
  const int d = static_cast<int>(vertices.size()) - 1;
  Eigen::MatrixXd edges(d, d);
  for (int k = 0; k < d; ++k) edges.col(k) = (X[vertices[k]] - X[vertices[d]]).head(d);
  Eigen::VectorXd c(d + 1);
  c.head(d) = least_squares(edges, e.head(d));
  c[d] = -c.head(d).sum();
  return c;
}

}  // namespace

Matrix across_gap(const Matrix& P, const Matrix& G, const std::vector<ContactNode>& nodes,
                  const Nodes& all, const FacedFacets& faced) {
  std::vector<char> has_law(all.X.size(), 0);
  for (const ContactNode& node : nodes) has_law[node.node] = 1;
  std::vector<Eigen::Triplet<Real, Index>> change;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Index i = nodes[k].node;
    Vec3 e = Vec3::Zero();
    for (Matrix::InnerIterator it(G, static_cast<Index>(k)); it; ++it)
      e += it.value() * (all.X[it.col()] - all.X[i]);
    const auto lawful = [&](Index l) { return has_law[l] != 0; };
    const auto usable = [&](const Facet& facet) {
      if (facet.behind < 0) return false;
      const std::vector<Index> vertices = element_of(facet, all.dimension);
      return std::none_of(vertices.begin(), vertices.end(), lawful);
    };
    Real whole = 0;
    for (const auto& [facet, weight] : faced[i])
      if (usable(*facet)) whole += std::max<Real>(weight, 0);
    for (const auto& [facet, signed_weight] : faced[i]) {
      const Real weight = std::max<Real>(signed_weight, 0);
      if (weight == 0 || !usable(*facet)) continue;
      const std::vector<Index> vertices = element_of(*facet, all.dimension);
      const Eigen::VectorXd c = shift(vertices, all.X, e);
      const Real room = (widest - c.lpNorm<Eigen::Infinity>()) / (widest - narrow);
      const Real share = std::clamp<Real>(room, 0, 1) * weight / whole;
      for (std::size_t v = 0; v < vertices.size() && share != 0; ++v)
        change.emplace_back(i, vertices[v], share * c[static_cast<Index>(v)]);
    }
  }
  if (change.empty()) return P;
  Matrix by(P.rows(), P.cols());
  by.setFromTriplets(change.begin(), change.end());
  return P + by;
}

}  // namespace frictioncg::mortar
