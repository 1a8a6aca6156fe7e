#pragma once
#include "assembly/mortar/normals.h"

namespace frictioncg::mortar {

/// What an increment goes on with from where it began.
struct Ranked {
  std::vector<std::vector<Index>> rank;     ///< per pair and facet, of its patch
  std::vector<Index> owner;                 ///< per node: rank of its patch, or -1
  std::vector<Index> pair;                  ///< per node, of the owning patch
  std::vector<Real> covered;                ///< per node: int lambda_i over what is covered
  std::vector<std::vector<char>> faced;     ///< per pair and facet of the master
  Slipping slipping;                        ///< of slave_normals()
  std::set<std::pair<Index, Index>> taken;  ///< Ownership::takes()
  std::vector<Index> nodes_of_patch;        ///< by rank: how many it has
  Index patches = 0;
};

/// visit(p, f, i): each vertex, node i, of each facet f of the side of each pair p.
template <class Visit>
void for_each_vertex(const std::vector<Side>& sides, const Visit& visit) {
  for (std::size_t p = 0; p < sides.size(); ++p)
    for (Index f = 0; f < sides[p].facets(); ++f)
      for (int v = 0; v < sides[p].d; ++v) visit(p, f, sides[p].facet(f).node[v]);
}

/// visit(p, f, i): the same of facets that something faces.
template <class Visit>
void for_each_covered(const Sides& of, const Visit& visit) {
  for_each_vertex(of.slaves, [&](std::size_t p, Index f, Index i) {
    if (!of.covers[p].cells[f].empty()) visit(p, f, i);
  });
}

/// Patches at a vertex are equally near what they face up to this share of a facet's size, and a
/// part that comes so near to a vertex reaches it: noise of meshes and of solutions decides
/// nothing.
constexpr Real equally_near = 0.01;

/// How far what faces it is from a vertex, facet by facet.
class Ways {
 public:
  /// rank: as in Ranked
  Ways(const Sides& of, const std::vector<std::vector<Index>>& rank);
  /// By how much it is farther along a facet than along the nearest one there [size of the facet];
  /// 0 where facets of one patch alone face something, or none reaches the vertex.
  Real farther(std::size_t p, Index f, Index i) const;

 private:
  Real way(std::size_t p, Index f, Index i) const;

  const Sides& of_;
  std::map<Index, Real> nearest_;  ///< of nodes where facets of several patches face something
};

/// Whether node i, a vertex of facet f of pair p, can have that one's law: no obstacle takes it, it
/// is on no master, and no Dirichlet condition holds the facet's normal there.
using Carries = std::function<bool(std::size_t p, Index f, Index i)>;

/// A facet whose patch has no node on it, nor on those around it, would have its law at nodes of
/// other faces, with their normals: a brick in a slot, one facet wide, would fall through the
/// ground. It takes the vertex where that costs least whose patch does without, there and around,
/// or gets another one in the same way.
void spare(const Sides& of, const Ways& ways, const Carries& carries, Ranked& ranked);

}  // namespace frictioncg::mortar
