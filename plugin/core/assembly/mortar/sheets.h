#pragma once
#include "assembly/mortar/cover.h"

namespace frictioncg::mortar {

/// The master before one slave facet may be several surfaces with a step between them: the tread
/// and the floor, two bodies of a pile. A gap averaged over both would lie outside of either. Keeps
/// the cells of the nearest one, and of those that continue it without a step: what is farther
/// away does not face.   size: of the slave facet; distance: of the plane of a cell's master
void keep_nearest_sheet(const Side& master, Real size,
                        const std::function<Affine(const Cell&)>& distance,
                        std::vector<Cell>& cells);

/// What a slave facet faces at its vertex v.   cells: of that facet, some
struct FacedAtVertex {
  Index facet;    ///< of the slave
  Index master;   ///< of the cell nearest to the vertex
  Real distance;  ///< of its plane along the slave's normal; what overlaps is below 0, and nearest
};
FacedAtVertex faced_at_vertex(int v, const Side& slave, Index facet, const Side& master,
                              const std::vector<Vec3>& X, const std::vector<Cell>& cells);

/// A slave facet at one of its vertices, both by their numbers.
using Corner = std::pair<Index, Index>;

/// The same from facet to facet: at a vertex whose facets face surfaces with a step between them, a
/// law over both would meet neither. Facets of the master that share a vertex are one surface,
/// however it is bent.   cells: per slave facet; returns those that face the farther ones, and
/// where
std::set<Corner> beyond_steps(const Side& slave, const Side& master, const std::vector<Vec3>& X,
                              const std::vector<std::vector<Cell>>& cells);

}  // namespace frictioncg::mortar
