#pragma once
#include "scene.h"

namespace frictioncg {

/// Refuses data that A and b cannot have been assembled with alike. Returns the largest entry of b
/// that counts as none, or 0. With `at` the load is A U + r, whose rows have such entries always.
/// u0 (ndof): where the increment starts, which has the data [length].
Real check_data(const Scene& scene, const Vector& b, const Vector& u0);
/// The same of all processes, by their own dofs of b. system: sums over them; extent: of the
/// contact boundary, or of the bodies [length].   Collective.
Real check_data(const Scene& scene, const Vector& b, const Vector& u0, const System& system,
                Real extent, const Processes& all);

/// Refuses b of one value at all nodes of a boundary, its ends included, and nowhere else, where A
/// has rows of tgv = -1: the data of an on() are such values, and no traction is. By any other A a
/// script may mean such nodal forces, and is told.
void check_one_value(const Scene& scene, const Vector& b, long verb);

/// Refuses b of a load where A has rows of tgv = -1, which would take it for displacements: on a
/// boundary that A holds, what a constant load per content makes of its nodes. Where it is what the
/// tractions of free neighbours leave at its ends, and 0 elsewhere, a script may mean it, and is
/// told.
void check_load_for_data(const Scene& scene, const Vector& b, long verb);

/// Refuses A of one space whose rows are those of scalar spaces, one component after the other:
/// where its supports lie inside of the body, or it has none, and translations and rotations leave
/// its rows without a force in that order alone.
void refuse_component_blocks(const Scene& scene, const Triplets& A);

/// Refuses those of lost_penalties().
void refuse_lost_penalties(const Scene& scene, const Triplets& A);

/// Whether the blocks of A are those of two spaces, of as many dofs each, in the other order.
bool are_exchanged(const Scene& scene, const Triplets& A);

/// Refuses the blocks of two spaces of as many dofs that come in the other order: where the
/// stiffness belongs to the other mesh, or, of meshes that differ by a translation, where supports
/// hold the whole slave, and none of it in the other order.
void refuse_exchanged_blocks(const Scene& scene, const Triplets& A);

}  // namespace frictioncg
