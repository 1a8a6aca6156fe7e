#pragma once
#include "assembly/mortar/integration.h"
#include "assembly/mortar/moments.h"
#include "assembly/mortar/owners.h"

namespace frictioncg::mortar {

/// Which vertices carry the laws on which slave facet.
///
/// Slave facets form patches, parted at sharp ridges, where two labels meet at an angle, and where
/// what they face has a step. Patches are ranked by pair, by label as listed, by their covered
/// measure; a vertex belongs to the patch that is nearest there to what it faces, of equally near
/// ones to the first, and is a removed node on the facets of others. Where that leaves none to a
/// facet, nor to those around it, another patch spares one. A node is removed everywhere where it
/// lies on the master too (tip of a crack), or on what a pair before its own uses as master (bodies
/// that meet crosswise), or where an obstacle takes it, or Dirichlet conditions hold its normal.
/// Where no vertex of a facet is kept, nodes of the nearest facet with some stand in, with constant
/// multipliers, so that no traction is lost where others of the pair have a law. Where what faces a
/// facet ends within it, the laws of its vertices beyond are of there.
///
/// Ranks, owners, nodes that lie on a master, how many motions slip and where masters' normals
/// count are those of where the increment began; of a node that nothing was before there they are
/// found here, by rank alone. A vertex beyond that had no law there gets one from for_a_law on.
struct Ownership : Ranked {
  /// begun: where the increment began; null: here. A cell whose master did not face anything there
  /// is taken off the covers where a node lies on it that would be removed: that is no master in
  /// this increment.
  Ownership(Sides& of, const Options& options, const struct Arrangement* begun);

  enum class State : char { uncovered, kept, shared, taken, held };
  std::vector<State> state;  ///< per node
  std::vector<long> label;   ///< per node
  std::vector<Vec3> normal;  ///< per node: given, or slave_normals()
  CommonNormals common;      ///< choose_common_normals()
  /// Whether the law of node i takes on itself what the removed node r moves by, since r's law
  /// would otherwise depend on that of i in a ring.
  bool takes(Index i, Index r) const { return taken.count({i, r}) > 0; }
  /// Whether the normals of some body of pair p let motions slip.
  bool slips(Index p) const;

  struct Carriers {
    std::array<bool, 3> kept{};   ///< vertices of the facet
    std::vector<Index> stand_in;  ///< nodes elsewhere, where none is kept
    /// By so much the strongest of the kept stands for all: from 0 to less than 1. What is barely
    /// covered has that one alone.
    Real alone = 0;
    std::array<bool, 3> strongest{};
    /// Of faces that slip the strongest sees itself alone: the others of a sliver, beyond the
    /// master, move along its normal, which is tangential at its own place. Not of bodies that are
    /// moved.
    bool at_node = false;
    /// Of the kept: 1 where something faces them, 0 where nothing near them does, but others of the
    /// facet; reach: how near what is covered comes to them, the largest lambda_v.
    Vec3 reached = Vec3::Ones(), reach = Vec3::Ones();
    Eigen::Matrix3d takes = Eigen::Matrix3d::Zero();  ///< (v, r): 1 where v takes r

    bool any_kept() const { return kept[0] || kept[1] || kept[2]; }
    /// The larger alone: of kept vertices that take removed ones on themselves none is to be left
    /// with less than a quarter of its d_i, from half of it on.   M: of dual_basis
    Real alone_in(const DualBasis& dual, const Eigen::Matrix3d& M) const {
      Real larger = alone;
      for (int v = 0; v < 3; ++v)
        if (!takes.row(v).isZero(0)) {
          const Real taken = (dual.psi.row(v) * M).dot(takes.row(v));
          larger = std::max(larger, std::min(1., -2 - 4 * taken / dual.d[v]));
        }
      return larger;
    }
    /// (k, i): what the multiplier of a vertex k beyond takes of that of another kept vertex i, so
    /// that its law is that of where what is covered ends, or a hair beyond it on slivers:
    ///
    ///   psi_k + sum_i (k, i) psi_i,   d_k / (d_k + sum_i (k, i) d_i) = max(reach_k, least)
    ///
    /// shared out by how much i is reached better than k. It takes less where no i is fully
    /// reached, so that these, too, come and go without a jump, and no more than all of psi_i.
    Eigen::Matrix3d borrowed(const DualBasis& dual) const {
      constexpr Real least = 0.05;  // its inverse is by how much these laws depend on the others
      Eigen::Matrix3d by = Eigen::Matrix3d::Zero();
      if (!leans()) return by;
      for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i)
          if (leans_on(k, i)) by(k, i) = reached[i] - reached[k];
        const Real others = by.row(k).dot(dual.d), best = by.row(k).maxCoeff();
        const Real lacking = dual.d[k] * (1 / std::max(reach[k], least) - 1);
        by.row(k) *= others > 0 ? best / (1 - reached[k]) * lacking / others : 0;
      }
      return by / std::max(1., by.colwise().sum().maxCoeff());
    }
    bool beyond(int v) const { return reached[v] < 1; }
    bool leans() const { return reached.minCoeff() < 1 && takes.isZero(0); }
    bool leans_on(int v, int w) const {
      return leans() && kept[v] && kept[w] && reached[v] < reached[w];
    }
    /// Whether r is removed beside a multiplier of v. On slivers, where r is beyond, that is next
    /// to nothing.
    bool depends(int v, int r) const {
      if (leans_on(v, r)) return true;
      if (leans() && beyond(r)) return false;
      const bool one_for_all = alone > 0 || !takes.isZero(0);
      return !kept[r] || (one_for_all && strongest[v]);
    }
  };
  std::vector<std::vector<Carriers>> carriers;  ///< per pair and slave facet

 private:
  void rank_patches(const Sides& of);
  /// ways: where it is decided here; by rank alone without
  void own(const Sides& of, const Ways* ways);
  void set_labels(const std::vector<Side>& slaves);
  void take_normals(const Nodes& nodes, const std::vector<Vec3>& normals);
  /// Whether a node of a slave lies on the master of pair p, or of one before it, of which a facet
  /// counts only where something faces it: the rest of its label is no master. Laws of later pairs
  /// alone may depend on a node with a law.
  bool on_master(Index i, Index p) const;
  void take_off_slaves(Sides& of) const;
  void remove_held(const Sides& of, const std::vector<Vec3>& deciding);
  void choose_carriers(Index p, const Side& slave, const Cover& cover, const Ownership* begun);
  void find_beyond(Index p, const Side& slave, const Cover& cover, const Ownership* begun);
  void put_off(Index p, const Side& slave, const Cover& cover, const std::vector<Carriers>& begun);
  /// part: what is covered, over what is barely so
  void thin_out(const Facet& facet, Real part, Carriers& of_facet) const;
  void find_stand_ins(Index p, const Side& slave, bool within_patch);
  void break_rings(const Sides& of);

  /// Per node with a law: 1 where something faces it, else how near that comes, from 0 to 1.
  std::vector<Real> reached_;
  std::set<std::pair<Index, Index>> on_own_;  ///< nodes of slaves on masters, and their pairs
  std::map<Index, Index> on_faced_;  ///< of those on facets that face something: the first pair
};

/// visit(i, psi, kept, d) for each multiplier of a slave facet: of node i, psi by coefficients over
/// the lambda of the facet, beside which the vertices that are not `kept` are removed nodes, and d
/// what it adds to D_i. One node may have several, and a share of each.
template <class Visit>
void for_each_multiplier(const Part& part, const Moments& moments,
                         const Ownership::Carriers& carriers, const Visit& visit) {
  const int d = part.slave.d;
  const auto of_vertices = [&](const DualBasis& dual, const std::array<bool, 3>& kept, Real share,
                               bool at_node) {
    const Eigen::Matrix3d borrowed = carriers.borrowed(dual);
    for (int v = 0; v < d; ++v) {
      if (!kept[v]) continue;
      const Real left = 1 - borrowed.col(v).sum();
      const Eigen::RowVector3d psi = left * dual.psi.row(v) + borrowed.row(v) * dual.psi;
      std::array<bool, 3> beside = kept;
      for (int w = 0; w < d; ++w) beside[w] = at_node || (kept[w] && borrowed(v, w) == 0);
      const Real d_v = at_node ? moments.vertices.topLeftCorner(d, d).sum() : left * dual.d[v];
      visit(part.node(v), Eigen::RowVector3d(share * psi), beside, share * d_v);
    }
  };
  const DualBasis dual = dual_basis(d, moments.vertices, carriers.kept);
  const Real alone = carriers.alone_in(dual, moments.vertices);
  of_vertices(dual, carriers.kept, 1 - alone, carriers.at_node && alone == 0);
  if (alone > 0)
    of_vertices(dual_basis(d, moments.vertices, carriers.strongest), carriers.strongest, alone,
                carriers.at_node);
  const Real share = 1. / static_cast<Real>(carriers.stand_in.size());
  for (Index i : carriers.stand_in)
    visit(i, Eigen::RowVector3d::Constant(share).eval(), carriers.kept, 0.);
}

/// The sides of all pairs, what is before what, and who carries laws.
struct Arrangement : Sides {
  /// parted: of the pairs given; begun: where the increment began, which has decided; null: it is
  /// decided here.
  Arrangement(const Nodes& nodes, std::vector<Pair> parted, const Options& options,
              const Arrangement* begun = nullptr);
  Arrangement(const Arrangement&) = delete;
  Arrangement& operator=(const Arrangement&) = delete;

  std::vector<Pair> pairs;  ///< parted
  std::optional<Ownership> ownership;
  RowChoices choices;  ///< where the increment began, then of now
};

/// Refuses a label that is slave and master of one pair, and nodes that the merging of meshes ties
/// together.
void validate_pairs(const Nodes& nodes, const std::vector<Pair>& pairs, const Options& options);

/// Refuses pairs where nothing faces, but for bodies that have moved (Nodes::reference), facets
/// without weight, pairs where no slave node is left to carry a law, and facets that face the
/// master of one pair while they are faced as the master of another.
void validate_cover(const Arrangement& of, const Options& options);

}  // namespace frictioncg::mortar
