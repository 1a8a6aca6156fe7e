#include "scene.h"

#include <Eigen/LU>

#include "core/statics/nearest_motion.h"
#include "core/statics/rigid_motions.h"

namespace frictioncg::test {

Posed Scene::system(const std::vector<Index>& mesh_node) const {
  BodyShape known;
  if (modes.cols() > 0) known.rigid_modes = [m = modes] { return m; };
  if (modes.cols() > 0 && !mesh_node.empty())
    known.slenderness = [m = modes, d = d, mesh_node] {
      const Eigen::MatrixXd X = places_of(mesh_node, d, m);
      std::vector<NodePlace> nodes(X.rows());
      for (std::size_t p = 0; p < nodes.size(); ++p) nodes[p].x.head(d) = X.row(Index(p));
      return slenderness(nodes, d);
    };
  return {std::make_unique<const LocalSystem>(triplets(), d, points, mesh_node, known), b, u_old,
          laws()};
}

Real& Scene::entry(Index row, Index column) {
  std::size_t k = 0;
  while (i.at(k) != row || j[k] != column) ++k;
  return a[k];
}

Eigen::MatrixXd rigid_motions_of(const Eigen::MatrixXd& X, int d) {
  Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(d * X.rows(), d == 2 ? 3 : 6);
  for (Index p = 0; p < X.rows(); ++p)
    for (int k = 0; k < d; ++k) {
      modes(d * p + k, k) = 1;
      for (int axis = d == 2 ? 2 : 0; axis < 3; ++axis)
        modes(d * p + k, d == 2 ? 2 : 3 + axis) =
            Eigen::Vector3d::Unit(axis).cross(Eigen::Vector3d(X.row(p)))[k];
    }
  return modes;
}

BlockOptions sheared_at_side(int d, Law law) {
  BlockOptions o;
  o.d = d;
  o.cells = d == 2 ? 8 : 3;
  o.law = law;
  o.clamp_side = true;
  o.shear = 4;
  return o;
}

Scene block(const BlockOptions& o) {
  const int d = o.d, m = o.cells + 1;
  const Index nodes = d == 2 ? m * m : m * m * m;
  const auto id = [&](int x, int y, int z) { return Index(x + m * (y + m * z)); };
  std::mt19937 random(o.seed);
  std::uniform_real_distribution<Real> uniform(-1, 1);
  const Real h = o.size / o.cells;

  Eigen::MatrixXd X(nodes, 3);
  for (int z = 0; z < (d == 3 ? m : 1); ++z)
    for (int y = 0; y < m; ++y)
      for (int x = 0; x < m; ++x) {
        X.row(id(x, y, z)) << x * h, y * h, z * h;
        const bool inside =
            x > 0 && x < m - 1 && y > 0 && y < m - 1 && (d == 2 || (z > 0 && z < m - 1));
        if (inside)
          for (int c = 0; c < d; ++c) X(id(x, y, z), c) += o.distortion * h * uniform(random);
      }
  // up is the last axis, the load shears along the first
  const int up = d - 1;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R = Eigen::AngleAxisd(o.angle, o.axis.normalized()).toRotationMatrix();

  std::vector<std::vector<Index>> simplices;
  for (int z = 0; z < (d == 3 ? m - 1 : 1); ++z)
    for (int y = 0; y < m - 1; ++y)
      for (int x = 0; x < m - 1; ++x) {
        if (d == 2) {
          simplices.push_back({id(x, y, 0), id(x + 1, y, 0), id(x + 1, y + 1, 0)});
          simplices.push_back({id(x, y, 0), id(x + 1, y + 1, 0), id(x, y + 1, 0)});
        } else {
          const int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
          for (const auto& order : axes) {
            int at[3] = {x, y, z};
            std::vector<Index> t{id(at[0], at[1], at[2])};
            for (int axis : order) {
              ++at[axis];
              t.push_back(id(at[0], at[1], at[2]));
            }
            simplices.push_back(t);
          }
        }
      }

  const Real lambda = o.E * o.nu / ((1 + o.nu) * (1 - 2 * o.nu)), G = o.E / (2 * (1 + o.nu));
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(d * nodes, d * nodes);
  for (const auto& t : simplices) {
    Eigen::MatrixXd M(d + 1, d + 1);
    for (int k = 0; k <= d; ++k) {
      M(k, 0) = 1;
      M.row(k).tail(d) = (R * X.row(t[k]).transpose()).head(d).transpose();
    }
    const Eigen::MatrixXd grad = M.inverse().bottomRows(d);  // column k: gradient of shape k
    const Real volume = std::abs(M.determinant()) / (d == 2 ? 2 : 6);
    for (int p = 0; p <= d; ++p)
      for (int q = 0; q <= d; ++q) {
        const Eigen::MatrixXd K =
            volume * (lambda * grad.col(p) * grad.col(q).transpose() +
                      G * grad.col(q) * grad.col(p).transpose() +
                      G * grad.col(p).dot(grad.col(q)) * Eigen::MatrixXd::Identity(d, d));
        A.block(d * t[p], d * t[q], d, d) += K;
      }
  }

  Scene s;
  s.d = d;
  s.n = d * nodes;
  s.law = o.law;
  s.modes = rigid_motions_of(X * R.transpose(), d);
  s.b = Vector::Zero(s.n);
  const Real share = std::pow(h, d - 1);
  std::vector<Real> share_of(nodes, 0);
  for (Index p = 0; p < nodes; ++p) {
    int at[3] = {int(p % m), int(p / m % m), int(p / (m * m))};
    Real w = share;
    for (int c = 0; c < d; ++c)
      if (c != up && (at[c] == 0 || at[c] == m - 1)) w /= 2;
    share_of[p] = w;
    if (at[up] == m - 1) {
      Eigen::Vector3d f = Eigen::Vector3d::Zero();
      f[up] = -o.pressure * w;
      f[0] = o.shear * w;
      s.b.segment(d * p, d) += (R * f).head(d);
    }
    if (at[up] == 0) {
      ContactPoint point;
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      normal[up] = -1;
      normal = R * normal;
      for (int c = 0; c < d; ++c) {
        point.dof[c] = d * p + c;
        point.normal[c] = normal[c];
      }
      point.friction = o.law != Law::frictionless && o.mu > 0;
      s.points.push_back(point);
    }
    if (o.clamp_side && at[0] == m - 1) {  // meaningful for angle = 0 only
      const Index k = d * p;
      s.b[k] = 0;
      if (o.tgv_minus_one)
        A.row(k).setZero(), A(k, k) = 1;
      else
        A(k, k) = 1e30;
    }
  }
  s.gap = Vector::Zero(Index(s.points.size()));
  s.friction = Vector::Constant(Index(s.points.size()), o.mu);
  for (Index p = 0; p < s.n; ++p)
    for (Index q = 0; q < s.n; ++q)
      if (A(p, q) != 0) {
        s.i.push_back(p);
        s.j.push_back(q);
        s.a.push_back(A(p, q));
      }
  return s;
}

}  // namespace frictioncg::test
