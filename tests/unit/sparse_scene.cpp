#include "sparse_scene.h"

#include <Eigen/LU>

namespace frictioncg::test {

namespace {

struct Mesh {
  Eigen::MatrixXd X;                            // nodes x d
  std::vector<std::array<Index, 4>> simplices;  // d + 1 vertices
  std::vector<Real> E;                          // of each simplex
  std::vector<std::array<int, 3>> at;           // lattice place of each node
};

Mesh make_mesh(const SparseOptions& o) {
  const int d = o.d, up = d - 1;
  const int nx = o.cells[0], ny = o.cells[1], nz = d == 3 ? o.cells[2] : 0;
  const auto id = [&](int x, int y, int z) { return Index(x + (nx + 1) * (y + (ny + 1) * z)); };
  std::mt19937 random(o.seed);
  std::uniform_real_distribution<Real> uniform(-1, 1);
  const int layers = o.cells[up];
  const Real q = layers > 1 ? std::pow(o.aspect, 1.0 / (layers - 1)) : 1;
  std::vector<Real> height(layers + 1, 0);
  for (int k = 0; k < layers; ++k) height[k + 1] = height[k] + std::pow(q, k);
  Mesh mesh;
  mesh.X.resize((nx + 1) * (ny + 1) * (nz + 1), d);
  mesh.at.resize(mesh.X.rows());
  for (int z = 0; z <= nz; ++z)
    for (int y = 0; y <= ny; ++y)
      for (int x = 0; x <= nx; ++x) {
        const int at[3] = {x, y, z};
        bool inside = true;
        for (int c = 0; c < d; ++c) {
          const Real cell =
              c == up
                  ? (height[std::min(at[c] + 1, layers)] - height[std::min(at[c], layers - 1)]) /
                        height[layers]
                  : 1.0 / o.cells[c];
          mesh.X(id(x, y, z), c) =
              o.size[c] * (c == up ? height[at[c]] / height[layers] : Real(at[c]) / o.cells[c]);
          inside = inside && at[c] > 0 && at[c] < o.cells[c] && cell > 0;
        }
        for (int c = 0; inside && c < d; ++c) {
          const Real cell =
              c == up ? (height[at[c]] - height[at[c] - 1]) / height[layers] : 1.0 / o.cells[c];
          mesh.X(id(x, y, z), c) += o.distortion * o.size[c] * cell * uniform(random);
        }
        mesh.at[id(x, y, z)] = {x, y, z};
      }
  const int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int z = 0; z < std::max(nz, 1); ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x)
        for (const auto& order : axes) {
          if (d == 2 && order[2] != 2) continue;
          int at[3] = {x, y, z};
          std::array<Index, 4> t{{id(x, y, z), 0, 0, 0}};
          for (int k = 0; k < d; ++k) {
            ++at[order[k]];
            t[k + 1] = id(at[0], at[1], at[2]);
          }
          const int octant = (2 * x >= nx) + (2 * y >= ny) + (d == 3 && 2 * z >= nz);
          mesh.simplices.push_back(t);
          mesh.E.push_back(octant % 2 ? 1000 * o.contrast : 1000);
        }
  return mesh;
}

/// Elasticity on the mesh, all dofs, rows sorted.
Matrix assemble(const Mesh& mesh, int d, Real nu) {
  const Index nodes = Index(mesh.X.rows());
  std::vector<std::vector<Index>> neighbours(nodes);
  for (const auto& t : mesh.simplices)
    for (int p = 0; p <= d; ++p)
      for (int q = 0; q <= d; ++q) neighbours[t[p]].push_back(t[q]);
  Matrix A(d * nodes, d * nodes);
  std::vector<Index> begin(nodes + 1, 0);
  for (Index i = 0; i < nodes; ++i) {
    auto& v = neighbours[i];
    std::sort(v.begin(), v.end());
    v.erase(std::unique(v.begin(), v.end()), v.end());
    begin[i + 1] = begin[i] + Index(v.size());
  }
  A.resizeNonZeros(d * d * begin[nodes]);
  std::fill(A.valuePtr(), A.valuePtr() + d * d * begin[nodes], 0.0);
  for (Index i = 0; i < nodes; ++i)
    for (int r = 0; r < d; ++r) {
      const Index row = d * d * begin[i] + r * d * Index(neighbours[i].size());
      A.outerIndexPtr()[d * i + r] = row;
      for (std::size_t k = 0; k < neighbours[i].size(); ++k)
        for (int c = 0; c < d; ++c) A.innerIndexPtr()[row + d * k + c] = d * neighbours[i][k] + c;
    }
  A.outerIndexPtr()[d * nodes] = d * d * begin[nodes];
  for (std::size_t s = 0; s < mesh.simplices.size(); ++s) {
    const auto& t = mesh.simplices[s];
    const Real lambda = mesh.E[s] * nu / ((1 + nu) * (1 - 2 * nu)), G = mesh.E[s] / (2 * (1 + nu));
    Eigen::MatrixXd M(d + 1, d + 1);
    for (int k = 0; k <= d; ++k) M(k, 0) = 1, M.row(k).tail(d) = mesh.X.row(t[k]);
    const Eigen::MatrixXd grad = M.inverse().bottomRows(d);
    const Real volume = std::abs(M.determinant()) / (d == 2 ? 2 : 6);
    for (int p = 0; p <= d; ++p)
      for (int q = 0; q <= d; ++q) {
        const auto& v = neighbours[t[p]];
        const Index k = Index(std::lower_bound(v.begin(), v.end(), t[q]) - v.begin());
        for (int r = 0; r < d; ++r)
          for (int c = 0; c < d; ++c)
            A.valuePtr()[A.outerIndexPtr()[d * t[p] + r] + d * k + c] +=
                volume * (lambda * grad(r, p) * grad(c, q) + G * grad(r, q) * grad(c, p) +
                          (r == c) * G * grad.col(p).dot(grad.col(q)));
      }
  }
  return A;
}

}  // namespace

SparseScene sparse_block(const SparseOptions& o) {
  const int d = o.d, up = d - 1;
  const Mesh mesh = make_mesh(o);
  const Matrix A = assemble(mesh, d, o.nu);
  SparseScene s;
  s.d = d;
  s.n = Index(A.rows());
  s.law = o.law;
  s.position = mesh.X;
  Eigen::MatrixXd X = Eigen::MatrixXd::Zero(mesh.X.rows(), 3);
  X.leftCols(d) = mesh.X;
  s.modes = rigid_motions_of(X, d);
  s.b = Vector::Zero(s.n);
  std::vector<char> fixed(s.n, 0);
  std::vector<Real> gap;
  Real share = 1;
  for (int c = 0; c < up; ++c) share *= o.size[c] / o.cells[c];
  for (Index p = 0; p < Index(mesh.at.size()); ++p) {
    const auto& at = mesh.at[p];
    Real w = share;
    for (int c = 0; c < up; ++c)
      if (at[c] == 0 || at[c] == o.cells[c]) w /= 2;
    const bool top = at[up] == o.cells[up], side = o.clamp_side && at[0] == 0;
    for (int c = 0; c < d; ++c) {
      s.node_of_dof.push_back(p);
      fixed[d * p + c] = side || (top && o.push_top);
    }
    if (top && !side) {
      if (o.push_top)
        s.b[d * p + up] = -o.depth * 1e30;
      else
        s.b[d * p + up] = -o.pressure * w, s.b[d * p] = o.shear * w;
    }
    if (at[up] == 0 && o.contact && !side) {
      ContactPoint point;
      const Real angle = o.tilt * (2 * mesh.X(p, 0) / o.size[0] - 1);
      for (int c = 0; c < d; ++c) point.dof[c] = d * p + c;
      point.normal[0] = std::sin(angle);
      point.normal[up] = -std::cos(angle);
      point.friction = o.law != Law::frictionless && o.mu > 0;
      point.mu_ratio = o.mu_ratio;
      if (d == 3) point.direction = {std::cos(0.3), std::sin(0.3), 0};
      s.points.push_back(point);
      Real r2 = 0;
      for (int c = 0; c < up; ++c) r2 += std::pow(mesh.X(p, c) - o.size[c] / 2, 2);
      gap.push_back(o.curvature * r2 / 2);
    }
  }
  s.gap = Eigen::Map<Vector>(gap.data(), Index(gap.size()));
  s.friction = Vector::Constant(Index(gap.size()), o.mu);
  for (Index p = 0; p < s.n; ++p)
    for (Matrix::InnerIterator e(A, p); e; ++e) {
      s.i.push_back(p);
      s.j.push_back(Index(e.col()));
      s.a.push_back(fixed[p] && e.col() == p ? 1e30 : e.value());
    }
  return s;
}

}  // namespace frictioncg::test
