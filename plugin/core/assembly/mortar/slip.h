#pragma once
#include "assembly/mortar/mortar.h"

namespace frictioncg::mortar {

/// What t.G(u - u_old) lacks of a slip that does not see how the bodies turn. Along smooth surfaces
/// G x has the offset of the facets, which a rigid turn rotates; the change of G does not.
/// Puso and Laursen 2004
///
///   slip = -(G - G_old) x,    c = slip - G (x - x_old) = G_old x - 2 G x + G x_old
///
/// x, x_old: the nodes now, and where the increment began. One vector for each contact node of
/// `now`, as a motion of its own node; 0 where nothing was before it then.
std::vector<Vec3> slip_beside(const Mortar& now, const std::vector<Vec3>& x, const Mortar& old,
                              const std::vector<Vec3>& x_old);

/// X with the mid-edges of P2 in the middle of their straight edges, as facets have them.
std::vector<Vec3> straightened(int d, const std::vector<Pair>& pairs, std::vector<Vec3> X);

/// The pairs of X with their nodes at Y: outside stays outside.
std::vector<Pair> carried(int d, std::vector<Pair> pairs, const std::vector<Vec3>& X,
                          const std::vector<Vec3>& Y);

}  // namespace frictioncg::mortar
