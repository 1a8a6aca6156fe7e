#pragma once
#include "assembly/mortar/cover.h"
#include "assembly/mortar/mortar.h"
#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

/// What a surface knows of its body: where its facets are before deformation.
struct OwnSurface {
  std::vector<Plane> planes;
  const std::vector<Vec3>& X;
  bool touches_itself;

  /// The side is at the nodes.
  OwnSurface(const Side& side, const Nodes& nodes, bool itself)
      : planes(nodes.reference.empty() ? side.planes
                                       : planes_at(side.d, side.surface, nodes.X, nodes.reference)),
        X(nodes.reference.empty() ? nodes.X : nodes.reference),
        touches_itself(itself) {}

  /// Whether facet m of the master lies behind f, below xi, as the other face of the same body: by
  /// more than half of what the body is thick there, or, beside a corner that f ends at, by what it
  /// is thick at the middle of f. Ends of a split ring, the faces of a crack or of a fold, which
  /// may overlap, have a thickness of their own.
  bool is_through_body(const Side& side, Index f, const Facet& m, const Vec2& xi) const;

  /// Whether facet m of the master is none that facet f can touch: m lies behind f, `distance` < 0
  /// away from xi, through the thickness of the body, or, of a surface that touches itself, they
  /// share a vertex, or it is deeper than an overlap is.   deepest: the size of the facets
  bool excludes(const Side& side, Index f, const Facet& m, const Vec2& xi, Real distance,
                Real deepest) const;
};

/// Whether the facets of slave and master are the same.
bool touches_itself(const Pair& pair);

/// Who is slave of whom on a surface that touches itself.
struct Roles {
  std::vector<char> is_slave;  ///< per facet
  /// All bodies in the order of their laws, and those that are before their slaves; empty of a pair
  /// that does not touch or face itself.
  std::vector<std::pair<Index, std::set<Index>>> faced;
};

/// Finds those of pairs that touch themselves of which it is not decided, and adds to the others
/// what bodies have come to be before. Of two bodies the slave is the later one in an order of all:
/// by smaller facets, then along the surface's own axes; a facet belongs to the body that it is
/// nearest to. Of facets of one body that face each other and what hangs together with them, a is
/// the direction along which they do so, the nearest before all:
///
///   (sum w n n') a = lambda a,   lambda the largest,   w = measure / (distance + size)
///
/// Slave is the side with the smaller facets, or with equal ones that whose mean place comes first
/// along the axes, both in the reference: however a body lies, moves and is numbered, they are the
/// same. A facet that faces nothing, or hardly looks along a, is on the side of the nearest other
/// one.
void find_roles(const Nodes& nodes, const std::vector<Pair>& pairs, Real maxgap,
                std::vector<Roles>& decided);

/// The pairs, where each facet of those that touch themselves is slave or master; a pair for each
/// body that has slaves, so that laws at a node with both roles have an order. None is a master
/// where they do not face themselves, which bodies that move may do.
std::vector<Pair> parted(const std::vector<Pair>& given, const std::vector<Roles>& roles,
                         bool moves);

}  // namespace frictioncg::mortar
