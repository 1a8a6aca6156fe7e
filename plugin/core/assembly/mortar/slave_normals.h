#pragma once
#include <functional>

#include "assembly/mortar/mortar.h"
#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

/// Whether facet f of the slave of pair p belongs to the patch that owns node i.
using Owns = std::function<bool(std::size_t p, Index f, Index i)>;

/// The normals of the laws, per node: of the smooth surface of the owning patch, where several of
/// its surfaces meet their mean; 0 where none owns the node. Motions that keep a body's slave in
/// contact, as far as the mesh can tell, do so exactly (slippable.h).
std::vector<Vec3> slave_normals(const Nodes& nodes, const std::vector<Side>& slaves,
                                const Options& options, const Owns& owns);

}  // namespace frictioncg::mortar
