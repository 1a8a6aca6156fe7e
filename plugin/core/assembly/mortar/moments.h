#pragma once
#include "assembly/mortar/mortar.h"
#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

/// A weight changes by no more than this share of it. Fits change by 1e-2 and less; what asks for
/// more lies further away than a facet is long, and gets a part. A law that takes on itself what
/// removed nodes move by (Ownership::takes) has its force beside them, by up to a facet: its row
/// follows by up to three times its weights, by 1.1 where corners of cubes on unlike meshes meet.
constexpr Real most_change = 0.3, most_where_taken = 3;

/// What is decided of a contact node's row where the increment began.
struct RowChoice {
  Real most_change = mortar::most_change;  ///< or most_where_taken
  std::optional<bool> along_normal;  ///< whether one with the master's normal sees it along that
  Index rank = 0;                    ///< of M below; 0: not asked for
};
using RowChoices = std::map<Index, RowChoice>;  ///< by node

/// What is singular in M, whose rank is 1 in 2D, and in 3D mostly 2. A rank that is decided stays
/// where pivots change by less than a hundredfold, as they do where bodies slide by no more than
/// the contact is wide.
inline Real singular(Index rank) { return rank == 0 ? 1e-6 : rank == 1 ? 1e-4 : 1e-8; }

/// P with rows whose normal forces have no moment. Forces G'y along n_i act on the slave at X_i and
/// on the master in the mean at sum_l P_il X_l, where the normals of the slave's facets lead; on
/// curved faces that point lies beside the normal n_i by
///
///   e = (1 - n n') sum_l G_il (X_l - X_i)
///
/// and the forces turn the bodies: without friction a shaft would hold a torque. The weights follow
/// the master's nodes along the surface:
///
///   P_il += |P_il| b.(X_l - mean)_t,   M b = e,   M = sum_l |P_il| (X_l - mean)_t (X_l - mean)_t'
///
/// which keeps their sum, and moves the mean point by -e. Where all facets at i are parallel to n_i
/// e is rounding, whatever the master is like (steps, rims), and the row stays as it is.
Matrix balanced(const Matrix& P, const Matrix& G, const std::vector<SlaveNode>& nodes,
                const std::vector<Vec3>& X, RowChoices& choices);

/// P with rows that see the master where the normals of their nodes meet it, for nodes whose
/// normals are the master's and whose moments could not be balanced: before a flat slave, what a
/// disc has at its sides lies further aside of its own normal through the node than weights may
/// move. Such rows would hold a disc that turns on a pin. Where a normal passes the master's rim, a
/// wheel's side, the row sees the point of the rim that is nearest: forces keep their moment about
/// the wheel's axis, wherever nodes are before the rim, and however rounding turns their normals.
///
/// of_master: per node, whether it has the master's normal; masters: per pair; choices: as far as
/// it is decided, the rest is added.
Matrix along_normals(const Matrix& P, const Matrix& G, const std::vector<SlaveNode>& nodes,
                     const std::vector<char>& of_master, const std::vector<Side>& masters,
                     const std::vector<Vec3>& X, RowChoices& choices);

/// Of a node: the master's facets before it, and int psi_i over each, where that is > 0.
using FacedFacets = std::vector<std::map<const Facet*, Real>>;

/// The element behind a facet of the master, by which a row sees across e, below.
struct Crossing {
  std::vector<Index> vertices;
  DenseMatrix gradients;  ///< of their barycentric coordinates, as rows [1/length]
  bool one_body = false;  ///< with the slave, or as good as one
  Real share = 0;         ///< of the facet in the row, times what does not fade out

  /// g: the node's gap along n; arm: sum_l G_il (X_l - X_i)
  Vec3 e(const Vec3& arm, const Vec3& n, Real g) const {
    return one_body ? arm : Vec3(arm + g * n);
  }
};
using Crossings = std::vector<std::vector<Crossing>>;  ///< per contact node

/// Facets without a vertex behind them, or of two bodies but for a path and for nodes that `turns`
/// names, of two bodies that are free to turn as one, and elements with a vertex that has a law of
/// this pair or a later one, add nothing; shares are those of the others.
Crossings crossings(const Matrix& G, const std::vector<SlaveNode>& nodes, const Nodes& all,
                    const std::vector<char>& turns, const FacedFacets& faced);

/// P with rows that see no rotation of a body that has both faces, such as one with a crack, or of
/// two that turn as one, such as a shaft in a hub that nothing holds. Where the faces are a hair
/// apart, forces G'y act at X_i on the slave and at sum_l P_il X_l on the master, and turn a free
/// body by the couple of friction and the gap, which nothing balances:
///
///   e = sum_l G_il (X_l - X_i)
///
/// The displacement of the master is therefore taken at X_i, across the gap, by the gradient that
/// it has in the element behind its face, vertices l with barycentric coordinates lambda_l:
///
///   P_il += sum_m s_im grad lambda_l . e,   so that sum_l G_il (X_l - X_i) = 0
///
/// in every component: the sums of rows stay, and forces and their moments balance. Along a path
/// the gap is closed where there are forces, and what smooth surfaces have between their facets,
/// and bent edges of P2 beside theirs, is left of e: friction would take work of two bodies that
/// stick and turn together. There
///
///   e = sum_l G_il (X_l - X_i) + g_i n_i
///
/// so that an open gap changes nothing but by how edges bend. s_im is the share of facet m in the
/// row: a row goes from facet to facet without a jump as bodies slide. The change, of about |e|
/// over the height of the element, is an error of the stress there: what is crossed fades out
/// between 0.8 of it and 1.2, and is left to the facets beside it. Weights of the facet's nodes
/// alone could not move a point across the gap: they lie in one plane.
Matrix across_gap(const Matrix& P, const Matrix& G, const std::vector<SlaveNode>& nodes,
                  const std::vector<Vec3>& X, const Crossings& crossings);

}  // namespace frictioncg::mortar
