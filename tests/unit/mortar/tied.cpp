#include "tied.h"

#include <Eigen/SparseCholesky>

namespace frictioncg::mortar::test {

Matrix change_of_basis(const Scene& s, const Mortar& mortar) {
  std::vector<Eigen::Triplet<Real, Index>> entries;
  for (int c = 0; c < s.d(); ++c) {
    std::vector<char> held(s.held.size());
    for (std::size_t i = 0; i < held.size(); ++i) held[i] = s.held[i] >> c & 1;
    const Matrix T = mortar.change_of_basis(held);
    for (Index i = 0; i < T.rows(); ++i)
      for (Matrix::InnerIterator it(T, i); it; ++it)
        entries.emplace_back(s.d() * i + c, s.d() * it.col() + c, it.value());
  }
  Matrix T(s.d() * s.bodies.nodes(), s.d() * s.bodies.nodes());
  T.setFromTriplets(entries.begin(), entries.end());
  return T;
}

Tied solve_tied(const Scene& s, const Mortar& mortar, bool normal_only) {
  const Matrix A = s.bodies.stiffness(), T = change_of_basis(s, mortar);
  const Index n = static_cast<Index>(A.rows());
  std::vector<char> fixed(n, 0);
  Vector w = Vector::Zero(n);
  for (const SlaveNode& node : mortar.nodes()) {
    int axis;
    node.normal.cwiseAbs().maxCoeff(&axis);
    for (int c = 0; c < s.d(); ++c)
      if (!normal_only || c == axis) fixed[s.d() * node.node + c] = 1;
  }
  for (Index i = 0; i < n; ++i)
    if (s.held[i / s.d()] >> (i % s.d()) & 1) fixed[i] = 1, w[i] = s.data[i];
  std::vector<Eigen::Triplet<Real, Index>> entries;
  Index free = 0;
  for (Index i = 0; i < n; ++i)
    if (!fixed[i]) entries.emplace_back(i, free++, 1);
  Matrix R(n, free);
  R.setFromTriplets(entries.begin(), entries.end());
  const Matrix TR = T * R;
  const Eigen::SparseMatrix<Real> reduced = TR.transpose() * Matrix(A * TR);
  const Vector rhs = TR.transpose() * Vector(s.load - A * (T * w));
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<Real>> factor(reduced);
  w += R * factor.solve(rhs);
  Tied result;
  result.u = T * w;
  result.residual = A * result.u - s.load;
  return result;
}

void hold_linear(Scene& s, const Eigen::Matrix3d& H,
                 const std::function<bool(const Vec3&)>& where) {
  for (Index i = 0; i < s.bodies.nodes(); ++i) {
    if (!where(s.bodies.X[i])) continue;
    const Vec3 u = H * s.bodies.X[i];
    for (int c = 0; c < s.d(); ++c) s.hold(i, c, u[c]);
  }
}

Real error_of(const Scene& s, const Vector& u, const Eigen::Matrix3d& H) {
  Real error = 0, size = 0;
  for (Index i = 0; i < s.bodies.nodes(); ++i) {
    const Vec3 exact = H * s.bodies.X[i];
    size = std::max(size, exact.norm());
    error = std::max(error, (u.segment(s.d() * i, s.d()) - exact.head(s.d())).norm());
  }
  return error / size;
}

Eigen::Matrix3d some_gradient(int d) {
  Eigen::Matrix3d H;
  H << 0.3, -0.7, 0.2, 0.5, -0.4, 0.6, -0.1, 0.8, 0.45;
  if (d == 2) H.row(2).setZero(), H.col(2).setZero();
  return H;
}

Vec3 distorted(int d, const Vec3& x, Real a, Real phase, Real turn) {
  Vec3 y = x;
  for (int c = 0; c < d; ++c)
    y[c] += a * x[c] * (1 - x[c]) * std::sin(5 * x[(c + 1) % d] + phase + 2 * c);
  if (d < 3 || turn == 0) return y;
  const Real angle = turn * std::min(1., 16 * y[0] * (1 - y[0]) * y[1] * (1 - y[1]));
  const Real px = y[0] - 0.5, py = y[1] - 0.5;
  y[0] = 0.5 + std::cos(angle) * px - std::sin(angle) * py;
  y[1] = 0.5 + std::sin(angle) * px + std::cos(angle) * py;
  return y;
}

Scene stacked(int d, bool quadratic, int lower, int upper, Real a, Real turn, const Map& place,
              Real ratio) {
  Scene s(d, quadratic);
  const int up = d - 1;
  s.bodies.add_box({lower, lower, lower},
                   [&](const Vec3& x) { return place(distorted(d, x, a, 0.4)); });
  const Index first = static_cast<Index>(s.bodies.elements.size());
  s.bodies.add_box(
      {upper, upper, upper},
      [&](const Vec3& x) {
        Vec3 y = distorted(d, x, a, 1.9, turn);
        y[up] += 1;
        return place(y);
      },
      ratio);
  const auto on_plane = [&](const Vec3& x) {
    const Vec3 o = place(Vec3::Zero()), n = place(Vec3::Unit(up)) - o;
    return std::abs((x - o).dot(n) - 1) < 1e-9;
  };
  Pair pair;
  pair.slave = {quadratic, {2}, s.bodies.boundary(on_plane, 2, first)};
  pair.master = {quadratic, {1}, s.bodies.boundary(on_plane, 1, 0, first)};
  s.pairs = {pair};
  s.start();
  return s;
}

}  // namespace frictioncg::mortar::test
