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
  Index master;   ///< of the cell nearest to the vertex
  Real distance;  ///< of that facet's plane, along the normal of the slave facet [length]
};
FacedAtVertex faced_at_vertex(int v, const Side& slave, Index facet, const Side& master,
                              const std::vector<Vec3>& X, const std::vector<Cell>& cells);

/// The same from facet to facet: at a vertex whose facets face surfaces with a step between them,
/// the farther ones face nothing: the vertex would meet neither. Two faces of the slave that meet
/// at an edge may face what lies at different distances. Facets of the master that share a vertex
/// are one surface, however it is bent.   cells: per slave facet; returns those that face nothing
std::vector<Index> beyond_steps(const Side& slave, const Side& master, const std::vector<Vec3>& X,
                                const std::vector<std::vector<Cell>>& cells);

}  // namespace frictioncg::mortar
