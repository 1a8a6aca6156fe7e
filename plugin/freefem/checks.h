#pragma once
#include "scene.h"

namespace frictioncg {

/// What the data of a call may be compared with.
struct Scales {
  Real extent = 0;     ///< of the contact boundary [length]
  Real moved = 0;      ///< what the load would move by the diagonal of A alone; 0 without a load
  Real stiffness = 0;  ///< mean of the diagonal of A on free dofs
  Real stiffest = 0;   ///< the largest of it
};

/// Refuses Dirichlet data in b, tgv u_D, where A has no Dirichlet row: they would be a load that
/// moves the body 1e10 times its own size and more. Larger than tgv makes them is a mere overflow.
void refuse_data_without_row(const Scene& scene, const Vector& b, const Scales& s);

/// What b has at the Dirichlet dofs of a body, where it is too small to be data of tgv = 1e30: how
/// many nodes have something there, and how many 0.
struct Leftover {
  Real loaded = 0, empty = 0;
  Real most = 0;  ///< the largest of b there [force]
  /// Of each component, the least and the largest.
  std::array<Real, 3> least, largest;
  Leftover();
  void add(const Scene& scene, const Vector& b, const NodePlace& n);
  /// One value for all nodes: forces of a mesh are smaller at the ends of a boundary.
  bool uniform() const;
};

/// The dof held whose data are largest, or -1 where all are 0. u0 (ndof): the data [length].
long largest_data(const Scene& scene, const Vector& b, const Vector& u0);
bool is_tiny(Real u, const Scales& s);

/// Refuses huge data.
void refuse_huge_data(const Scene& scene, const Vector& b, const Vector& u0, const Scales& s);

/// Data that are next to nothing are 0 where b = A U + r leaves the rest: what the other entries of
/// the row make of a displacement U, at every node, of its own size at each. Refused is what they
/// cannot make (U as large as a thousand bodies), what is the same at all nodes (data of another
/// tgv), and loads at some nodes only, 0 at most of them (b without the on() of A). i: the dof of
/// the largest data.
void refuse_tiny_data(const Scene& scene, const Vector& b, const Vector& u0, long i,
                      const Scales& s, const Leftover& left);

/// Refuses data that A and b cannot have been assembled with alike. Returns the largest entry of b
/// that counts as none, or 0. With `at` the load is A U + r, whose rows have such entries always.
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
