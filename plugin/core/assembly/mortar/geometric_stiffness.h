#pragma once
#include "assembly/mortar/integration.h"
#include "assembly/mortar/ownership.h"

namespace frictioncg::mortar {

/// The weights of one contact node i, before they are balanced: row i of (I + N) C^-1 but for the 1
/// of i itself, and of P, by columns.
struct SlopedRow {
  Sloped D;
  std::map<Index, Sloped> own, theirs, removed;  ///< those of removed nodes until all are added
  Vec3 between = Vec3::Zero();                   ///< int psi_i (delta_m(chi) - delta_s) / D_i
  Sloped offset;                                 ///< the same along a normal n_i that stands
};

/// Rows of the contact nodes that the last contact force loads. The facet of slave f adds, by
///
///   d phi_l(chi) = sum_v (d phi_l / d lambda_v) h_v.(dx + g dn_f - dchi)
///   dn_f = -sum_v grad lambda_v (n_f.dX_v),   d measure = measure sum_v grad lambda_v.dX_v
///
/// h_v: the gradient of the master's lambda_v along the slave's plane; x on the slave, chi on the
/// master, g between them. The borders of cells move, too, which changes nothing within the
/// master's surface, where its trace functions are continuous. The rim of what is covered is taken
/// to stand still, and so are the weights of the integrals.
class WeightSlopes {
 public:
  /// force: at each node, or empty: there are no rows.
  /// normals: of the laws, at each node.
  WeightSlopes(const std::vector<Vec3>& X, const std::vector<Vec3>& force,
               const std::vector<Vec3>& normals)
      : X_(X), force_(force), normals_(normals) {}
  void add(const Part& part, const Moments& moments, const Integration& integration,
           const Ownership::Carriers& carriers);
  /// By node, once all facets are added. takes(i, r): as Assembly::place_removed says.
  std::map<Index, SlopedRow> rows(const std::function<bool(Index, Index)>& takes) const;

 private:
  const std::vector<Vec3>&X_, &force_, &normals_;
  std::map<Index, SlopedRow> sums_;
};

/// d(G'y)/dX, where the forces y keep their parts along normals and tangents: both turn with the
/// slave (turns_of_normal),
///
///   dy_i = (n_i x dn_i) x y_i
///
/// and dg_i/dX of the nodes that y loads. Left out are the rims of what is covered, normals that
/// the master gives or the caller, and the shares of crossings: they are taken to stand still.
///
/// y of Options::force are those of the mortar, whose rows are given; none where it is empty.
GeometricStiffness geometric_stiffness(const Mortar& mortar, const Arrangement& of,
                                       const std::map<Index, SlopedRow>& rows,
                                       const Crossings& crossings, const Options& options);

/// To first order, where U grows by v, and by it the places of nodes by x: those of P2 edges stay
/// between their ends.
struct Change {
  std::vector<Vec3> force;  ///< of G'y, at each node
  Vector gap;  ///< of g + n.G U, the bound on n.G u at each contact node; 0 where y loads none
};
Change change(const Mortar& mortar, const std::vector<Vec3>& v, const std::vector<Vec3>& x);

}  // namespace frictioncg::mortar
