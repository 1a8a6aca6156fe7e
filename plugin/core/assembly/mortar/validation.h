#pragma once
#include "assembly/mortar/ownership.h"

namespace frictioncg::mortar {

/// Refuses a label that is slave and master of one pair, and nodes that the merging of meshes ties
/// together.
void validate_pairs(const Nodes& nodes, const std::vector<Pair>& pairs, const Options& options);

/// Refuses pairs where nothing faces, but for bodies that have moved (Nodes::reference), facets
/// without weight, pairs where no slave node is left to carry a law, and facets that face the
/// master of one pair while they are faced as the master of another.
void validate_cover(const Arrangement& of, const Options& options);

}  // namespace frictioncg::mortar
