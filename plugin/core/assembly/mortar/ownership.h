#pragma once
#include "assembly/mortar/cover.h"
#include "assembly/mortar/mortar.h"

namespace frictioncg::mortar {

/// Which vertices carry the laws on which slave facet.
///
/// Slave facets form patches, parted at sharp ridges and where two labels meet at an angle. Patches
/// are ranked by pair, by label as listed, by their covered measure; a vertex belongs to the first
/// patch that covers something there, and is a removed node on the facets of others. It is removed
/// everywhere where it lies on the master too (tip of a crack), or on what another pair uses as
/// master (bodies that meet crosswise), or where an obstacle takes it, or Dirichlet conditions hold
/// its normal. Where no vertex of a facet is kept, nodes of the nearest facet with some stand in,
/// with constant multipliers, so that nowhere a traction is lost.
struct Ownership {
  Ownership(const Nodes& nodes, const std::vector<Side>& slaves, const std::vector<Side>& masters,
            const std::vector<Cover>& covers, const Options& options);

  enum class State : char { uncovered, kept, shared, taken, held };
  static constexpr int states = 5;
  std::vector<State> state;     ///< per node
  std::vector<Index> pair;      ///< per node, of the owning patch
  std::vector<long> label;      ///< per node
  std::vector<Vec3> normal;     ///< per node: given, or slave_normals()
  std::vector<char> of_master;  ///< per node: the normal is the master's, choose_common_normals()
  /// Per node: measure covered around it, where it is decided what faces what.
  std::vector<Real> covered;

  struct Carriers {
    std::array<bool, 3> kept{};   ///< vertices of the facet
    std::vector<Index> stand_in;  ///< nodes elsewhere, where none is kept
    /// By so much the strongest of the kept stands for all: from 0 to less than 1. What is barely
    /// covered has that one alone.
    Real alone = 0;
    std::array<bool, 3> strongest{};
  };
  std::vector<std::vector<Carriers>> carriers;  ///< per pair and slave facet

 private:
  struct Patch;
  void rank_patches(const std::vector<Side>& slaves, const std::vector<Cover>& covers);
  void own(const std::vector<Side>& slaves, const std::vector<Cover>& covers);
  void set_labels(const std::vector<Side>& slaves);
  void take_normals(const Nodes& nodes, const std::vector<Vec3>& normals);
  void remove_shared(const std::vector<Side>& masters, const std::vector<Cover>& covers);
  void remove_taken(const std::vector<char>& taken);
  void remove_held(const Nodes& nodes, const std::vector<Side>& slaves,
                   const std::vector<Vec3>& deciding);
  void choose_carriers(Index p, const Side& slave, const Cover& cover);
  void thin_out(const Facet& facet, Real fraction, Carriers& of_facet) const;
  void find_stand_ins(Index p, const Side& slave, bool within_patch);

  std::vector<std::vector<Index>> rank_;  ///< per pair and facet, of its patch: the lower one owns
  std::vector<Index> owner_;              ///< per node: rank of its patch, or -1
  Index patches_ = 0;
};

}  // namespace frictioncg::mortar
