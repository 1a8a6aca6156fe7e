#pragma once
#include "assembly/mortar/weight_slopes.h"

namespace frictioncg::mortar {

/// d(G'y)/dX, where the forces y keep their parts along normals and tangents: both turn with the
/// slave,
///
///   dy_i = (n_i x dn_i) x y_i,   n_i ~ sum_f n_f sin(alpha_f) / (|e_f| |e'_f|)
///
/// alpha_f the angle of facet f at i, between the edges e_f and e'_f (2D: n_f / |e_f|): exact on
/// circles and spheres [Max]. Left out are the rims of what is covered, normals that the master
/// gives or the caller, which are taken to stand still, and what across_gap changes.
///
/// y of Options::force are those of the mortar, whose rows are given; none where it is empty.
NodeBlocks geometric_stiffness(const Mortar& mortar, const Nodes& nodes,
                               const std::vector<Side>& slaves,
                               const std::map<Index, SlopedRow>& rows, const Options& options);

}  // namespace frictioncg::mortar
