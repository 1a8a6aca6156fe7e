#include "statics.h"

#include <Eigen/Dense>

namespace frictioncg::test {

double distance_to_cone(Eigen::MatrixXd G, Eigen::VectorXd t) {
  const int rows = int(G.rows()), columns = int(G.cols());
  for (int i = 0; i < rows; ++i)
    if (t[i] < 0) {
      t[i] = -t[i];
      G.row(i) *= -1;
    }
  Eigen::MatrixXd T(rows, columns + rows + 1);  // one artificial variable a row
  T << G, Eigen::MatrixXd::Identity(rows, rows), t;
  Eigen::RowVectorXd cost = -T.colwise().sum();
  cost.segment(columns, rows).setZero();
  std::vector<int> basis(rows);
  for (int i = 0; i < rows; ++i) basis[i] = columns + i;
  const double tiny = 1e-11 * (1 + G.cwiseAbs().maxCoeff());
  for (int step = 0; step < 20000; ++step) {
    int enter = -1;
    for (int j = 0; j < columns && enter < 0; ++j)
      if (cost[j] < -tiny) enter = j;
    if (enter < 0) break;
    int leave = -1;
    double least = 0;
    for (int i = 0; i < rows; ++i) {
      if (T(i, enter) <= 1e-11) continue;
      const double ratio = T(i, columns + rows) / T(i, enter);
      if (leave >= 0 && (ratio > least || (ratio == least && basis[i] > basis[leave]))) continue;
      least = ratio;
      leave = i;
    }
    if (leave < 0) break;
    T.row(leave) /= T(leave, enter);
    for (int i = 0; i < rows; ++i)
      if (i != leave) T.row(i) -= T(i, enter) * T.row(leave);
    cost -= cost[enter] * T.row(leave);
    basis[leave] = enter;
  }
  return std::abs(cost[columns + rows]);
}

RigidStatics::RigidStatics(const Scene& s) : s_(s) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(s.n, s.n);
  for (std::size_t k = 0; k < s.a.size(); ++k) A(s.i[k], s.j[k]) += s.a[k];
  std::vector<int> free;
  for (int i = 0; i < s.n; ++i)
    if (A(i, i) < 1e20) free.push_back(i);
  Eigen::MatrixXd B(free.size(), free.size());
  for (std::size_t p = 0; p < free.size(); ++p)
    for (std::size_t q = 0; q < free.size(); ++q)
      B(p, q) = A(free[p], free[q]) / std::sqrt(A(free[p], free[p]) * A(free[q], free[q]));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(B);
  int k = 0;
  while (k < B.rows() && eigen.eigenvalues()[k] < 1e-11) ++k;
  W_ = Eigen::MatrixXd::Zero(s.n, k);
  for (std::size_t p = 0; p < free.size(); ++p)
    W_.row(free[p]) = eigen.eigenvectors().row(p).head(k) / std::sqrt(A(free[p], free[p]));
  if (k > 0) W_ /= W_.cwiseAbs().maxCoeff();
  load_ = W_.transpose() * s.b;
}

bool RigidStatics::held(double friction_factor, const Eigen::VectorXd& more, bool around) const {
  if (motions() == 0) return true;
  const Eigen::VectorXd t = load_ + more;
  const double size = std::max(load_.norm(), 1e-300);
  if (t.norm() < 1e-9 * s_.b.lpNorm<1>()) return true;
  return distance_to_cone(columns(friction_factor, around), t / size) < 1e-9;
}

int RigidStatics::verdict(double margin) const {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(motions());
  const bool now = held(1, none);
  bool sure = held(1 - margin, none) == now && held(1 + margin, none, true) == now;
  for (int k = 0; k < motions() && sure; ++k)
    for (double sign : {-1.0, 1.0}) {
      const Eigen::VectorXd more =
          sign * margin * load_.norm() * Eigen::VectorXd::Unit(motions(), k);
      sure &= held(1, more, !now) == now;
    }
  if (!now) return sure ? -1 : 0;
  return sure ? 1 : 0;
}

Eigen::MatrixXd RigidStatics::columns(double friction_factor, bool around) const {
  const int sides = 16;
  std::vector<Eigen::VectorXd> c;
  for (std::size_t p = 0; p < s_.points.size(); ++p) {
    if (!std::isfinite(s_.gap[p])) continue;
    Eigen::Vector3d n(s_.points[p].normal.data());
    Eigen::MatrixXd w(s_.d, motions());
    for (int k = 0; k < s_.d; ++k) w.row(k) = W_.row(s_.points[p].dof[k]);
    double mu =
        s_.law == Law::coulomb && s_.points[p].friction ? friction_factor * s_.friction[p] : 0;
    std::vector<Eigen::Vector3d> tangents;
    if (s_.d == 2) {
      tangents = {{-n[1], n[0], 0}, {n[1], -n[0], 0}};
    } else {
      const Eigen::Vector3d t1 = n.unitOrthogonal(), t2 = n.cross(t1);
      for (int k = 0; k < sides; ++k)
        tangents.push_back(std::cos(2 * M_PI * k / sides) * t1 +
                           std::sin(2 * M_PI * k / sides) * t2);
      if (around) mu /= std::cos(M_PI / sides);
    }
    for (const Eigen::Vector3d& t : tangents) c.push_back(w.transpose() * (n + mu * t).head(s_.d));
  }
  Eigen::MatrixXd G(motions(), c.size());
  for (std::size_t k = 0; k < c.size(); ++k) G.col(k) = c[k];
  return G;
}

Scene ladder(double degrees, double mu_floor, double mu_wall, int n, int m) {
  const double th = degrees * M_PI / 180, c = std::cos(th), s = std::sin(th), l = 4, t = 0.2;
  const double E = 1e5, nu = 0.3, lambda = E * nu / ((1 + nu) * (1 - 2 * nu)),
               G = E / (2 * (1 + nu));
  const auto id = [&](int i, int j) { return i + (n + 1) * j; };
  std::vector<Eigen::Vector2d> X;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      const double a = l * i / n, b = t * (double(j) / m - 0.5);
      X.emplace_back(a * c - b * s, a * s + b * c);
    }
  Scene scene;
  scene.n = 2 * Index(X.size());
  scene.b = Vector::Zero(scene.n);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(scene.n, scene.n);
  const auto add = [&](std::array<int, 3> v) {
    Eigen::Matrix3d M;
    for (int k = 0; k < 3; ++k) M.row(k) << 1, X[v[k]].x(), X[v[k]].y();
    const Eigen::Matrix3d inverse = M.inverse();
    const Eigen::Matrix<double, 2, 3> grad = inverse.bottomRows(2);
    const double area = std::abs(M.determinant()) / 2;
    for (int p = 0; p < 3; ++p) {
      scene.b[2 * v[p] + 1] -= area / 3;
      for (int q = 0; q < 3; ++q)
        A.block(2 * v[p], 2 * v[q], 2, 2) +=
            area * (lambda * grad.col(p) * grad.col(q).transpose() +
                    G * grad.col(q) * grad.col(p).transpose() +
                    G * grad.col(p).dot(grad.col(q)) * Eigen::Matrix2d::Identity());
    }
  };
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      add({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      add({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  const double floor = X[id(0, 0)].y() < X[id(0, m)].y() ? X[id(0, 0)].y() : X[id(0, m)].y();
  double wall = -1e9;
  for (int j = 0; j <= m; ++j) wall = std::max(wall, X[id(n, j)].x());
  std::vector<double> gap, mu;
  for (int end : {0, n})
    for (int j = 0; j <= m; ++j) {
      ContactPoint point;
      point.dof = {2 * id(end, j), 2 * id(end, j) + 1, -1};
      point.normal = end == 0 ? Eigen::Vector3d(0, -1, 0) : Eigen::Vector3d(1, 0, 0);
      point.friction = true;
      scene.points.push_back(point);
      gap.push_back(end == 0 ? X[id(end, j)].y() - floor : wall - X[id(end, j)].x());
      mu.push_back(end == 0 ? mu_floor : mu_wall);
    }
  scene.gap = Eigen::Map<Vector>(gap.data(), Index(gap.size()));
  scene.friction = Eigen::Map<Vector>(mu.data(), Index(mu.size()));
  for (Index p = 0; p < scene.n; ++p)
    for (Index q = 0; q < scene.n; ++q)
      if (A(p, q) != 0) {
        scene.i.push_back(p);
        scene.j.push_back(q);
        scene.a.push_back(A(p, q));
      }
  return scene;
}

}  // namespace frictioncg::test
