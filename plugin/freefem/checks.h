#pragma once
#include "scene.h"

namespace frictioncg {

/// What b has at the Dirichlet dofs of a body, where it is too small to be data of tgv = 1e30: how
/// many nodes have something there, and how many 0.
struct Leftover {
  Real loaded = 0, empty = 0;
  Real most = 0;  ///< the largest of b there [force]
  /// Of each component, the least and the largest.
  Vec3 least = Vec3::Constant(infinity), largest = -least;
  void add(const Scene& scene, const Vector& b, const NodePlace& n);
  /// One value for all nodes: forces of a mesh are smaller at the ends of a boundary.
  bool uniform() const;
};

/// What processes that share a scene have together, and do alike.
struct Together {
  const System& system;  ///< sums over them
  Real extent;           ///< of the contact boundary, or of the body [length]
  std::function<bool(Index dof)> owns;
  std::function<void(const std::function<void()>&)> agree;  ///< runs what each does by itself
  std::function<std::vector<Leftover>()> leftovers;         ///< of each body
};

/// Refuses data that A and b cannot have been assembled with alike. Returns the largest entry of b
/// that counts as none, or 0. With `at` the load is A U + r, whose rows have such entries always.
/// u0 (ndof): where the increment starts, which has the data [length].
Real check_data(const Scene& scene, const Vector& b, const Vector& u0, const Together& all);
Real check_data(const Scene& scene, const Vector& b, const Vector& u0);

/// Refuses b of one value at all nodes of a boundary, its ends included, and nowhere else, where A
/// has rows of tgv = -1: the data of an on() are such values, and no traction is. By any other A a
/// script may mean such nodal forces, and is told.
void check_one_value(const Scene& scene, const Vector& b, long verb);

/// Refuses b of a load where A has rows of tgv = -1, which would take it for displacements: on a
/// boundary that A holds, what a constant load per content makes of its nodes. Where it is what the
/// tractions of free neighbours leave at its ends, and 0 elsewhere, a script may mean it, and is
/// told.
void check_load_for_data(const Scene& scene, const Vector& b, long verb);

/// Whether the blocks of A are those of two spaces, of as many dofs each, in the other order.
bool are_exchanged(const Scene& scene, const Triplets& A);

/// Refuses the blocks of two spaces of as many dofs that come in the other order: where the
/// stiffness belongs to the other mesh, or, of meshes that differ by a translation, where supports
/// hold the whole slave, and none of it in the other order.
void refuse_exchanged_blocks(const Scene& scene, const Triplets& A);

}  // namespace frictioncg
