#pragma once
#include "assembly/mortar/mortar.h"

namespace frictioncg::mortar {

/// What two lists of labels, not empty, stand for: of equal length, slave[k] faces master[k]; a
/// single label faces all of the other list. A slave label that is named several times faces the
/// union of its masters, and slave labels that face the same masters are one surface. Pairs without
/// facets.
///
/// Throws IllegalInput for other lengths.
std::vector<Pair> label_pairs(const std::vector<long>& slave, const std::vector<long>& master);

}  // namespace frictioncg::mortar
