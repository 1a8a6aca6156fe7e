#pragma once
#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

using Mat3 = Eigen::Matrix3d;
using Turns = std::map<Index, Mat3>;  ///< dn/dX_j by j

/// The sum that the normal n of a node is along, with its derivatives: over the facets around it
/// that are one surface with it,
///
///   n ~ sum_f n_f sin(alpha_f) / (|e_f| |e'_f|)
///
/// alpha_f the angle of facet f at the node, between the edges e_f and e'_f (2D: n_f / |e_f|):
/// exact on circles and spheres [Max]. In 2D that is the circle through the node and the two beside
/// it; at the end of a line of facets the next two vertices have the circle,
///
///   n ~ n_f / |e_f| - n' / |e'|
///
/// e' to the farther one, n' across it.
class TurningNormal {
 public:
  TurningNormal(Index i, const Vec3& n, const std::vector<Vec3>& X) : i_(i), n_(n), X_(X) {}
  void add(const Side& side, Index f);
  /// Once all facets are added. smooth: as in is_smooth.
  void end(const Side& side, const std::vector<char>& smooth = {});
  Turns turns() const;

 private:
  void add(const Vec3& e, const Vec3& other, Index j, const Vec3& n_f, Real factor = 1);
  Mat3& slope(Index j) { return slopes_.try_emplace(j, Mat3::Zero()).first->second; }

  Index i_;
  Vec3 n_;
  const std::vector<Vec3>& X_;
  Real sign_ = 1;
  Index facets_ = 0, facet_ = -1, beside_ = -1;  ///< how many; 2D: the last, and its other vertex
  Vec3 sum_ = Vec3::Zero();
  Turns slopes_;
};

}  // namespace frictioncg::mortar
