#include "statics/slenderness.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "linear_algebra.h"

namespace frictioncg {

namespace {

/// Places of the mesh nodes, a row each, in some unit, from the modes. Along a node's translation
/// into y its rotation about z goes as x, in any frame. A node that a support holds may lack it.
Eigen::MatrixXd places_of(const System& system, const Eigen::MatrixXd& modes) {
  const int d = system.dimension;
  const std::size_t nodes = 1 + *std::max_element(system.mesh_node.begin(), system.mesh_node.end());
  std::vector<Index> count(nodes, 0), row(nodes, -1);
  Index whole = 0;
  for (const Index node : system.mesh_node)
    if (++count[node] == d) row[node] = whole++;
  Eigen::MatrixXd place = Eigen::MatrixXd::Zero(whole, d);
  for (Index i = 0; i < system.dofs(); ++i) {
    const Index r = row[system.mesh_node[i]];
    if (r < 0) continue;
    if (d == 2) {
      place(r, 0) += modes(i, 2) * modes(i, 1);
      place(r, 1) -= modes(i, 2) * modes(i, 0);
      continue;
    }
    for (int k = 0; k < d; ++k) place(r, k) += modes(i, 3 + (k + 2) % d) * modes(i, (k + 1) % d);
  }
  return place;
}

}  // namespace

Real slenderness(const System& system) {
  if (!system.rigid_modes || system.mesh_node.empty()) return 1;
  const Eigen::MatrixXd modes = system.rigid_modes();
  if (modes.rows() != system.dofs() || modes.cols() != (system.dimension == 2 ? 3 : 6)) return 1;
  Eigen::MatrixXd place = places_of(system, modes);
  if (place.rows() < 2) return 1;
  place.rowwise() -= place.colwise().mean().eval();
  const Vector extent = eigenpairs(place.transpose() * place).values;
  return extent[0] > 0 ? std::sqrt(extent.tail(1)[0] / extent[0]) : 1;
}

}  // namespace frictioncg
