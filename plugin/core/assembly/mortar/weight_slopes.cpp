#include "assembly/mortar/geometric_stiffness.h"

namespace frictioncg::mortar {

namespace {

/// Of the trace functions with respect to the barycentric coordinates: d phi_l / d lambda_v.
Eigen::Matrix<Real, 6, 3> shape_slopes(int d, bool quadratic, const Vec3& lambda) {
  Eigen::Matrix<Real, 6, 3> slopes = Eigen::Matrix<Real, 6, 3>::Zero();
  for (int v = 0; v < d; ++v) slopes(v, v) = quadratic ? 4 * lambda[v] - 1 : 1;
  for (int k = 0; quadratic && k < edges_of_facet(d); ++k) {
    const auto [a, b] = edge_ends(d, k);
    slopes(d + k, a) = 4 * lambda[b];
    slopes(d + k, b) = 4 * lambda[a];
  }
  return slopes;
}

/// grad lambda_v of a facet in its plane, as columns.
Eigen::Matrix3d gradients(int d, const Plane& plane) {
  Eigen::Matrix3d grad = Eigen::Matrix3d::Zero();
  for (int v = 1; v < d; ++v) {
    grad.col(v) = plane.B.row(v - 1).transpose();
    grad.col(0) -= grad.col(v);
  }
  return grad;
}

/// Of one cell, and of each lambda_u of the slave's facet times phi^m_l(chi), and times the offset
/// delta_m(chi) by components: the derivatives of the integral with respect to the vertices of the
/// slave and of the master, where the arcs of the offset stay.
class CellSlopes {
 public:
  CellSlopes(const Integration& integration, const Part& part, const Cell& cell,
             const std::vector<Vec3>& X)
      : d_(part.slave.d) {
    const Plane& plane = part.slave.planes[part.facet];
    const Projection chi = project(d_, plane, part.master.facet(cell.master), X);
    const Eigen::Matrix3d grad = gradients(d_, plane);
    Eigen::Matrix3d h;
    for (int v = 0; v < 3; ++v) h.col(v) = plane.B.transpose() * chi.lambda[v].g;
    const bool quadratic = part.master.surface.quadratic;
    const CurvedOffset* offset = integration.of_master();
    std::vector<QuadraturePoint> points;
    quadrature(cell.part, points);
    for (const QuadraturePoint& point : points) {
      const Vec3 lambda = slave_coordinates(d_, point.xi), theirs = chi.at(point.xi);
      const Vec3 weighted = integration.measure(part, point) * lambda;
      Eigen::Matrix<Real, 9, 3> along = Eigen::Matrix<Real, 9, 3>::Zero();
      along.topRows<6>() = shape_slopes(d_, quadratic, theirs) * h.transpose();  // d phi_l / dx
      if (offset) along.bottomRows<3>() = offset->slopes(cell.master, theirs) * h.transpose();
      for (int k = 0; k < edges_of_facet(d_); ++k) {
        const auto [a, b] = edge_ends(d_, k);
        arcs_.col(k) += theirs[a] * theirs[b] * weighted;
      }
      const Real g = chi.distance(point.xi);
      for (int l = 0; l < 9; ++l)
        for (int v = 0; v < d_; ++v) {
          const Vec3 H = along.row(l);
          const Vec3 of_slave = lambda[v] * H - g * H.dot(grad.col(v)) * plane.normal;
          slave_.block<3, 3>(3 * l, 3 * v) += of_slave * weighted.transpose();
          master_.block<3, 3>(3 * l, 3 * v) -= theirs[v] * H * weighted.transpose();
        }
    }
  }
  /// int psi lambda_a lambda_b over edge k of the master.
  Real arc(int k, const Eigen::RowVector3d& psi) const { return psi * arcs_.col(k); }
  /// Adds the slopes of int psi phi_l(chi), psi given over the lambda_u; l = 6, 7, 8: delta_m.
  void add(const Part& part, const Facet& master, int l, const Eigen::RowVector3d& psi,
           Sloped& to) const {
    for (int v = 0; v < d_; ++v) {
      to.at(part.node(v)) += slave_.block<3, 3>(3 * l, 3 * v) * psi.transpose();
      to.at(master.node[v]) += master_.block<3, 3>(3 * l, 3 * v) * psi.transpose();
    }
  }

 private:
  using Table = Eigen::Matrix<Real, 27, 9>;  ///< 3 x 3 by l and v: columns u
  int d_;
  Table slave_ = Table::Zero(), master_ = Table::Zero();
  Eigen::Matrix3d arcs_ = Eigen::Matrix3d::Zero();
};

/// What one facet adds to the rows of the nodes that carry its multipliers.
class FacetSlopes {
 public:
  FacetSlopes(const Integration& integration, const Part& part, const Moments& moments,
              const std::vector<Vec3>& X)
      : part_(part), moments_(moments), integration_(integration) {
    measure_.value = 1;
    const Eigen::Matrix3d grad = gradients(part.slave.d, part.slave.planes[part.facet]);
    for (int v = 0; v < part.slave.d; ++v) measure_.slope[part.node(v)] = grad.col(v);
    for (const Cell& cell : part.cells) cells_.emplace_back(integration, part, cell, X);
  }

  void add(const Eigen::RowVector3d& psi, const std::array<bool, 3>& kept, Real D, const Vec3& n,
           SlopedRow& row) const {
    const int d = part_.slave.d;
    row.D.add(measure_, D);
    for (int v = 0; v < d; ++v)
      if (!kept[v]) row.removed[part_.node(v)].add(measure_, psi.dot(moments_.vertices.col(v)));
    for (int k = 0; part_.slave.surface.quadratic && k < edges_of_facet(d); ++k) {
      const Real weight = psi.dot(moments_.edges.col(k));  // u~_e = u_e - (u_a + u_b)/2
      row.own[part_.node(d + k)].add(measure_, weight);
      for (int end : edge_ends(d, k)) row.own[part_.node(end)].add(measure_, -weight / 2);
    }
    for (std::size_t c = 0; c < part_.cells.size(); ++c) {
      const Facet& master = part_.master.facet(part_.cells[c].master);
      for (int l = 0; l < nodes_of_facet(d, part_.master.surface.quadratic); ++l) {
        Sloped& weight = row.theirs[master.node[l]];
        weight.add(measure_, psi.dot(moments_.master[c].col(l)));
        cells_[c].add(part_, master, l, psi, weight);
      }
    }
    if (integration_.of_master()) add_offset(psi, n, row);
  }

 private:
  void add_offset(const Eigen::RowVector3d& psi, const Vec3& n, SlopedRow& row) const {
    const CurvedOffset &slave = *integration_.of_slave(), &master = *integration_.of_master();
    CurvedOffset::Bends of_slave, of_master;
    const Vec3 offset = (psi * moments_.offset).transpose();
    row.between += offset;
    row.offset.add(measure_, n.dot(offset));
    for (int k = 0; k < edges_of_facet(part_.slave.d); ++k) {
      slave.add_slopes(part_.facet, k, -psi.dot(moments_.edges.col(k)) / 4 * n, row.offset,
                       of_slave);
      for (std::size_t c = 0; c < cells_.size(); ++c)
        master.add_slopes(part_.cells[c].master, k, cells_[c].arc(k, psi) * n, row.offset,
                          of_master);
    }
    slave.add_slopes(of_slave, row.offset);
    master.add_slopes(of_master, row.offset);
    for (std::size_t c = 0; c < cells_.size(); ++c)
      for (int l = 6; l < 9; ++l)
        cells_[c].add(part_, part_.master.facet(part_.cells[c].master), l, n[l - 6] * psi,
                      row.offset);
  }

  const Part& part_;
  const Moments& moments_;
  const Integration& integration_;
  Sloped measure_;  ///< over itself
  std::vector<CellSlopes> cells_;
};

}  // namespace

void WeightSlopes::add(const Part& part, const Moments& moments, const Integration& integration,
                       const Ownership::Carriers& carriers) {
  bool loaded = false;
  for (int k = 0; k < nodes_of_facet(part.slave.d, part.slave.surface.quadratic); ++k)
    loaded = loaded || (!force_.empty() && !force_[part.node(k)].isZero(0));
  for (Index i : carriers.stand_in) loaded = loaded || (!force_.empty() && !force_[i].isZero(0));
  if (!loaded) return;
  const FacetSlopes facet(integration, part, moments, X_);
  for_each_multiplier(part, moments, carriers,
                      [&](Index i, const auto& psi, const auto& kept, Real d) {
                        facet.add(psi, kept, d, normals_[i], sums_[i]);
                      });
}

std::map<Index, SlopedRow> WeightSlopes::rows(
    const std::function<bool(Index, Index)>& takes) const {
  std::map<Index, SlopedRow> rows = sums_;
  for (auto& [node, row] : rows) {  // D > 0: a node that stands in has facets, too
    for (const auto& [r, weight] : row.removed) {
      if (!takes(node, r)) {
        row.own[r].add(weight, 1);
        continue;
      }
      const Vec3& n = normals_[node];
      const Vec3 way = X_[r] - X_[node];
      row.D.add(weight, 1);
      row.between -= weight.value * way;
      row.offset.add(weight, -n.dot(way));
      row.offset.at(r) -= weight.value * n;
      row.offset.at(node) += weight.value * n;
    }
    row.removed.clear();
    const auto divide = [&D = row.D](Sloped& weight) {
      weight.value /= D.value;
      for (const auto& [j, by] : D.slope) weight.at(j) -= weight.value * by;
      for (auto& [j, by] : weight.slope) by /= D.value;
    };
    for (auto* side : {&row.own, &row.theirs})
      for (auto& [column, weight] : *side) divide(weight);
    divide(row.offset);
    row.between /= row.D.value;
  }
  return rows;
}

}  // namespace frictioncg::mortar
