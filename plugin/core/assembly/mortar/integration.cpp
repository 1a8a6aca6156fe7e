#include "assembly/mortar/integration.h"

#include "linear_algebra.h"

namespace frictioncg::mortar {

namespace {

/// Where the bodies are not deformed, for facets whose edges bend.
std::vector<Vec3> at_rest(const Side& side, const Nodes& nodes) {
  return side.surface.quadratic && !nodes.bent.empty() ? nodes.reference : std::vector<Vec3>();
}

}  // namespace

Integration::Integration(const Side& slave, const Side& master, const Nodes& nodes,
                         const Options& options)
    : nodes_(nodes),
      options_(options),
      slave_(slave, master, nodes.X, at_rest(slave, nodes)),
      master_(master, slave, nodes.X, at_rest(master, nodes)) {}

Vec3 Integration::bend_at(const Facet& facet, const Vec3& lambda) const {
  const int d = nodes_.dimension;
  Vec3 bend = Vec3::Zero();
  for (int k = 0; k < edges_of_facet(d) && !nodes_.bent.empty() && facet.node[d + k] >= 0; ++k) {
    const auto [a, b] = edge_ends(d, k);
    const Index e = facet.node[d + k];
    bend += 4 * lambda[a] * lambda[b] * (nodes_.bent[e] - nodes_.X[e]);
  }
  return bend;
}

Real Integration::measure(const Part& part, const QuadraturePoint& point) const {
  const int d = part.slave.d;
  const Vec3 lambda = slave_coordinates(d, point.xi);
  Real weight = options_.weight.empty() ? 1 : 0;
  for (int v = 0; v < d && !options_.weight.empty(); ++v)
    weight += lambda[v] * options_.weight[part.node(v)];
  return part.slave.planes[part.facet].measure / extent(reference_facet(d)) * point.weight * weight;
}

Moments Integration::over(const Part& part) const {
  const int d = part.slave.d;
  const bool quadratic = part.master.surface.quadratic;
  const Plane& plane = part.slave.planes[part.facet];
  Moments moments;
  std::vector<QuadraturePoint> points;
  for (const Cell& cell : part.cells) {
    const Projection chi = project(d, plane, part.master.facet(cell.master), nodes_.X);
    Eigen::Matrix<Real, 3, 6> of_cell = Eigen::Matrix<Real, 3, 6>::Zero();
    quadrature(cell.part, points);
    for (const Vec2& corner : cell.part)
      moments.least = std::min(moments.least, chi.distance(corner));
    for (const QuadraturePoint& point : points) {
      const Vec3 lambda = slave_coordinates(d, point.xi), on_master = chi.at(point.xi);
      const Real measured = measure(part, point);
      const Vec3 weighted = measured * lambda;
      const Shape phi_m = shape_functions(d, quadratic, on_master);
      of_cell += weighted * Eigen::Map<const Eigen::Matrix<Real, 1, 6>>(phi_m.data());
      moments.vertices += weighted * lambda.transpose();
      const Vec3 theirs = master_.at(cell.master, on_master), own = slave_.at(part.facet, lambda);
      const Vec3 offset = options_.smooth ? Vec3(theirs - own) : Vec3(Vec3::Zero());
      const Vec3 bend_m = bend_at(part.master.facet(cell.master), on_master),
                 bend_s = bend_at(part.slave.facet(part.facet), lambda);
      moments.bulge = std::max(moments.bulge, std::abs(plane.normal.dot(theirs + bend_m)) +
                                                  std::abs(plane.normal.dot(own + bend_s)));
      moments.offset += weighted * offset.transpose();
      const Real distance = chi.distance(point.xi) + plane.normal.dot(offset + bend_m - bend_s);
      for (int k = 0; k < edges_of_facet(d); ++k) {
        const auto [a, b] = edge_ends(d, k);
        moments.edges.col(k) += 4 * lambda[a] * lambda[b] * weighted;
        moments.distance[k] += 4 * lambda[a] * lambda[b] * measured * distance;
      }
    }
    moments.master.push_back(of_cell);
  }
  return moments;
}

DualBasis dual_basis(int d, const Eigen::Matrix3d& M, const std::array<bool, 3>& kept) {
  DualBasis basis;
  std::vector<int> K;
  for (int v = 0; v < d; ++v)
    if (kept[v]) K.push_back(v);
  const int size = static_cast<int>(K.size());
  if (size == 0) return basis;
  DenseMatrix chi(size, d);
  for (int j = 0; j < size; ++j)
    for (int v = 0; v < d; ++v) chi(j, v) = v == K[j] ? 1 : kept[v] ? 0 : 1. / size;
  const DenseMatrix coefficients = solve(chi * M.topRows(d)(Eigen::all, K), chi);
  for (int i = 0; i < size; ++i) {
    basis.d[K[i]] = M.col(K[i]).sum();
    basis.psi.row(K[i]).head(d) = basis.d[K[i]] * coefficients.row(i);
  }
  return basis;
}

}  // namespace frictioncg::mortar
