#include "bodies.h"

#include <Eigen/LU>

namespace frictioncg::mortar::test {

std::vector<std::array<int, 2>> ends(int d) {
  if (d == 2) return {{1, 2}, {0, 2}, {0, 1}};
  return {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
}

void MeshedBodies::add_box(std::array<int, 3> n, const Map& shape, Real young) {
  const Index base = nodes();
  const int nz = d == 3 ? n[2] : 0;
  const auto id = [&](int x, int y, int z) { return base + x + (n[0] + 1) * (y + (n[1] + 1) * z); };
  for (int z = 0; z <= nz; ++z)
    for (int y = 0; y <= n[1]; ++y)
      for (int x = 0; x <= n[0]; ++x)
        X.push_back(shape(Vec3(Real(x) / n[0], Real(y) / n[1], nz > 0 ? Real(z) / nz : 0)));
  std::map<std::array<Index, 2>, Index> middle;
  const auto add = [&](Element e) {
    if (quadratic)
      for (const auto& end : ends(d)) {
        const Index a = e[end[0]], b = e[end[1]];
        const auto at =
            middle.emplace(std::array<Index, 2>{std::min(a, b), std::max(a, b)}, nodes());
        if (at.second) X.push_back((X[a] + X[b]) / 2);
        e.push_back(at.first->second);
      }
    elements.push_back(e);
    E.push_back(young);
  };
  for (int z = 0; z < std::max(nz, 1); ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x) {
        if (d == 2) {
          add({id(x, y, 0), id(x + 1, y, 0), id(x + 1, y + 1, 0)});
          add({id(x, y, 0), id(x + 1, y + 1, 0), id(x, y + 1, 0)});
          continue;
        }
        for (const auto& order :
             {std::array<int, 3>{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}) {
          int at[3] = {x, y, z};
          Element e{id(x, y, z)};
          for (int axis : order) {
            ++at[axis];
            e.push_back(id(at[0], at[1], at[2]));
          }
          add(e);
        }
      }
}

void MeshedBodies::merge(const std::function<bool(const Vec3&)>& where) {
  std::vector<Index> target(X.size());
  for (Index i = 0; i < nodes(); ++i) {
    target[i] = i;
    for (Index j = 0; j < i && where(X[i]); ++j)
      if (target[j] == j && (X[i] - X[j]).norm() < 1e-10) target[i] = j;
  }
  std::vector<Index> number(X.size());
  std::vector<Vec3> kept;
  for (Index i = 0; i < nodes(); ++i) {
    if (target[i] != i) continue;
    number[i] = static_cast<Index>(kept.size());
    kept.push_back(X[i]);
  }
  for (Element& e : elements)
    for (Index& i : e) i = number[target[i]];
  X = kept;
}

std::vector<Facet> MeshedBodies::boundary(const std::function<bool(const Vec3&)>& where, long label,
                                          Index first, Index last) const {
  std::map<std::vector<Index>, std::pair<int, Facet>> all;
  if (last < 0) last = static_cast<Index>(elements.size());
  for (Index k = first; k < last; ++k) {
    const Element& e = elements[k];
    const auto between = [&](Index a, Index b) {
      const auto edges = ends(d);
      for (std::size_t q = 0; q < edges.size(); ++q) {
        const Index p = e[edges[q][0]], r = e[edges[q][1]];
        if ((p == a && r == b) || (p == b && r == a)) return e[d + 1 + q];
      }
      return Index(-1);
    };
    for (int opposite = 0; opposite <= d; ++opposite) {
      Facet facet;
      facet.label = label;
      int v = 0;
      Vec3 c = Vec3::Zero();
      for (int q = 0; q <= d; ++q)
        if (q != opposite) c += X[facet.node[v++] = e[q]] / d;
      facet.outward = c - centroid(e);
      for (int q = 0; quadratic && q < edges_of_facet(d); ++q) {
        const auto [a, b] = edge_ends(d, q);
        facet.node[d + q] = between(facet.node[a], facet.node[b]);
      }
      std::vector<Index> key(facet.node.begin(), facet.node.begin() + d);
      std::sort(key.begin(), key.end());
      auto& entry = all[key];
      ++entry.first;
      entry.second = facet;
    }
  }
  std::vector<Facet> facets;
  for (const auto& [key, entry] : all) {
    Vec3 c = Vec3::Zero();
    for (Index i : key) c += X[i] / d;
    if (entry.first == 1 && where(c)) facets.push_back(entry.second);
  }
  return facets;
}

Eigen::MatrixXd gradients(int d, bool quadratic, const Eigen::MatrixXd& of_lambda,
                          const Eigen::VectorXd& lambda) {
  if (!quadratic) return of_lambda;
  const auto edges = ends(d);
  Eigen::MatrixXd g(d, d + 1 + edges.size());
  for (int v = 0; v <= d; ++v) g.col(v) = (4 * lambda[v] - 1) * of_lambda.col(v);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const auto [a, b] = edges[k];
    g.col(d + 1 + k) = 4 * (lambda[a] * of_lambda.col(b) + lambda[b] * of_lambda.col(a));
  }
  return g;
}

Matrix MeshedBodies::stiffness() const {
  std::vector<Eigen::Triplet<Real, Index>> entries;
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const Element& e = elements[k];
    const Real lame = E[k] * nu / ((1 + nu) * (1 - 2 * nu)), G = E[k] / (2 * (1 + nu));
    Eigen::MatrixXd M(d + 1, d + 1);
    for (int v = 0; v <= d; ++v) M.row(v) << 1, X[e[v]].head(d).transpose();
    const Eigen::MatrixXd of_lambda = M.inverse().bottomRows(d);
    const Real volume = std::abs(M.determinant()) / (d == 2 ? 2 : 6);
    for (int q = 0; q <= d; ++q) {  // degree 2
      const Real near = d == 2 ? 2. / 3 : (5 + 3 * std::sqrt(5.)) / 20;
      Eigen::VectorXd lambda = Eigen::VectorXd::Constant(d + 1, (1 - near) / d);
      lambda[q] = near;
      const Eigen::MatrixXd g = gradients(d, quadratic, of_lambda, lambda);
      for (Index i = 0; i < g.cols(); ++i)
        for (Index j = 0; j < g.cols(); ++j) {
          const Eigen::MatrixXd block =
              volume / (d + 1) *
              (lame * g.col(i) * g.col(j).transpose() + G * g.col(j) * g.col(i).transpose() +
               G * g.col(i).dot(g.col(j)) * Eigen::MatrixXd::Identity(d, d));
          for (int a = 0; a < d; ++a)
            for (int b = 0; b < d; ++b)
              entries.emplace_back(d * e[i] + a, d * e[j] + b, block(a, b));
        }
    }
  }
  Matrix A(d * nodes(), d * nodes());
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

void MeshedBodies::add_traction(const Facet& facet, const Vec3& traction, Vector& F) const {
  const Plane plane = plane_of(d, facet, X);
  for (int k = 0; k < nodes_of_facet(d, quadratic); ++k) {
    const Real share = !quadratic ? 1. / d
                       : d == 2   ? (k < 2 ? 1. / 6 : 2. / 3)
                                  : (k < 3 ? 0 : 1. / 3);
    F.segment(d * facet.node[k], d) += share * plane.measure * traction.head(d);
  }
}

}  // namespace frictioncg::mortar::test
