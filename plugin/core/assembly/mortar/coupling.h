#pragma once
#include "assembly/basis.h"
#include "assembly/dirichlet.h"
#include "assembly/mortar/mortar.h"

namespace frictioncg::mortar {

/// Bits of the components that Dirichlet conditions hold: Nodes::held.
std::vector<unsigned char> held_components(int d, const NodeDofs& dof, const Dirichlet& dirichlet);

/// The mortar on the n dofs of the script, component by component; taken: as in Nodes, whose
/// displacements stay what they are.
Coupling couple(const Mortar& mortar, int d, const NodeDofs& dof, const Dirichlet& dirichlet,
                Index n, const std::vector<char>& taken = {});

/// The same of entries of both: dofs that are not coupled have rows of the identity.
Coupling on_all_dofs(const std::vector<char>& coupled, EntryList T, EntryList W);

}  // namespace frictioncg::mortar
