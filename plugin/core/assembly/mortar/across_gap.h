#pragma once
#include "assembly/mortar/mortar.h"

namespace frictioncg::mortar {

/// P with rows that see no rotation of a body that has both faces, such as one with a crack. Where
/// the faces are a hair apart, forces G'y act at X_i on the slave and at sum_l P_il X_l on the
/// master, and turn a free body by the couple of friction and the gap, which nothing balances:
///
///   e = sum_l G_il (X_l - X_i)
///
/// The displacement of the master is therefore taken at X_i, across the gap, by the gradient that
/// it has in the element behind its face, vertices l with barycentric coordinates lambda_l:
///
///   P_il += grad lambda_l . e,   so that sum_l G_il (X_l - X_i) = 0
///
/// in every component: the sums of rows stay, and forces and their moments balance. The change, of
/// about |e| over the height of the element, is an error of the stress there: no gap above a tenth
/// of it is crossed. Weights of the facet's nodes alone could not move a point across the gap:
/// they lie in one plane.
///
/// partner: per node of P the facet of the master that faces it most, or null. Facets without a
/// vertex behind them, and elements with a vertex that carries a law, are left as they are.
Matrix across_gap(const Matrix& P, const Matrix& G, const std::vector<ContactNode>& nodes,
                  const Nodes& all, const std::vector<const Facet*>& partner);

}  // namespace frictioncg::mortar
