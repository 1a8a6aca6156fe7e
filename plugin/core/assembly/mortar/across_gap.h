#pragma once
#include "assembly/mortar/mortar.h"

namespace frictioncg::mortar {

/// Of a node: the master's facets before it, and int psi_i over each; one may come several times.
using FacedFacets = std::vector<std::vector<std::pair<const Facet*, Real>>>;

/// P with rows that see no rotation of a body that has both faces, such as one with a crack. Where
/// the faces are a hair apart, forces G'y act at X_i on the slave and at sum_l P_il X_l on the
/// master, and turn a free body by the couple of friction and the gap, which nothing balances:
///
///   e = sum_l G_il (X_l - X_i)
///
/// The displacement of the master is therefore taken at X_i, across the gap, by the gradient that
/// it has in the element behind its face, vertices l with barycentric coordinates lambda_l:
///
///   P_il += sum_m s_im grad lambda_l . e,   so that sum_l G_il (X_l - X_i) = 0
///
/// in every component: the sums of rows stay, and forces and their moments balance. s_im is the
/// share of facet m in the row: a row goes from facet to facet without a jump as bodies slide. The
/// change, of about |e| over the height of the element, is an error of the stress there: what is
/// crossed fades out between a tenth of it and 0.15. Weights of the facet's nodes alone could not
/// move a point across the gap: they lie in one plane.
///
/// Facets without a vertex behind them, and elements with a vertex that carries a law, add nothing;
/// shares are those of the others.
Matrix across_gap(const Matrix& P, const Matrix& G, const std::vector<ContactNode>& nodes,
                  const Nodes& all, const FacedFacets& faced);

}  // namespace frictioncg::mortar
