#pragma once
#include "core/assembly/mortar/sheets.h"
#include "surfaces.h"

namespace frictioncg::mortar::test {

/// Slave facets of the first pair that face something beyond a step, and where.
inline std::set<Corner> steps_of(const Surfaces& s) {
  const int d = s.nodes.dimension;
  const Side slave(d, s.pairs[0].slave, s.nodes.X), master(d, s.pairs[0].master, s.nodes.X);
  const Cover all = cover(s.nodes, false, slave, master, s.options.maxgap);
  return beyond_steps(slave, master, s.nodes.X, all.cells);
}

}  // namespace frictioncg::mortar::test
