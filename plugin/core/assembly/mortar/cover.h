#pragma once
#include "assembly/mortar/clipping.h"
#include "assembly/mortar/mortar.h"
#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

/// A part of a slave facet, and the master facet before it.
struct Cell {
  Index master = 0;
  Polygon part;  ///< in reference coordinates of the slave facet
};

/// Which part of each slave facet faces the master: along the normal of the slave facet, no further
/// than maxgap, and the nearest master facet where several lie one behind the other, or side by
/// side with a step between them.
struct Cover {
  std::vector<std::vector<Cell>> cells;  ///< per slave facet
  std::vector<Real> fraction;            ///< covered share of each slave facet, 0 .. 1
  std::size_t visited = 0;               ///< nodes of the tree and pairs of facets looked at
  Real nearest = 0;  ///< distance of the nearest facing facet, where nothing is covered [length]
};

/// The sides of all pairs, and what is before what.
struct Sides {
  const Nodes& nodes;
  std::vector<Side> slaves = {}, masters = {};
  std::vector<Cover> covers = {};
};

/// The same sides where it was decided what faces what.
struct Earlier {
  const Side &slave, &master;
  const std::vector<Vec3>& X;
};

/// What the sides of a pair have before each other at the nodes. itself: they are of a surface that
/// touches itself; earlier: none where it is decided here. What maxgap leaves out there is left
/// out, so that the cells move on with the nodes. Throws IllegalInput where the bodies overlap by
/// more than a facet.
Cover cover(const Nodes& nodes, bool itself, const Side& slave, const Side& master, Real maxgap,
            const std::optional<Earlier>& earlier = {});

}  // namespace frictioncg::mortar
