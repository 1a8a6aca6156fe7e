#pragma once
#include "model/system.h"

namespace frictioncg {

/// How slender all bodies together are: the longest over the shortest radius of gyration of the
/// mesh nodes, about L/t of a beam or a plate. 1 where the system does not tell its rigid modes.
Real slenderness(const System& system);

}  // namespace frictioncg
