#pragma once
#include "assembly/mortar/mortar.h"
#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

/// P with rows that see the master where the normals of their nodes meet it, for nodes whose
/// normals are the master's and whose moments could not be balanced: before a flat slave, what a
/// disc has at its sides lies further aside of its own normal through the node than weights may
/// move. Such rows would hold a disc that turns on a pin. Nodes whose normals meet nothing keep
/// their row.
///
/// of_master: per node, whether the normal is the master's; masters: per pair.
Matrix along_normals(const Matrix& P, const Matrix& G, const std::vector<ContactNode>& nodes,
                     const std::vector<char>& of_master, const std::vector<Side>& masters,
                     const std::vector<Vec3>& X);

}  // namespace frictioncg::mortar
