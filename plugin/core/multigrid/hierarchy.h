#pragma once
#include "model/system.h"
#include "multigrid/node_blocks.h"

namespace frictioncg {

/// A stiffness that a law adds to the tangents of a contact node: M on the dofs first, first + 1.
struct TangentialStiffness {
  Index first;
  Eigen::Matrix2d M;  ///< symmetric positive semi-definite [force/length]
};

/// v is 0 on those of its last dofs that are fixed.
inline void drop_fixed(const std::vector<char>& fixed, Vector& v) {
  const Eigen::Index interior = v.size() - Eigen::Index(fixed.size());
  for (std::size_t c = 0; c < fixed.size(); ++c)
    if (fixed[c]) v[interior + Eigen::Index(c)] = 0;
}

/// k unknowns q beside the n of a truncated A:   [A B; B' S]
struct Border {
  std::vector<Index> row;  ///< those of B that may not be 0
  DenseMatrix B;           ///< rows of `row` x k, 0 on fixed dofs
  DenseMatrix S;           ///< k x k, definite where A is
};

/// Smoothed aggregation with rigid-body modes for A, in single precision: a symmetric positive
/// definite approximate inverse, one cycle. Structure and prolongations come from A once; contact
/// dofs are then cut out or put back on every level at the price of their own rows:
///
///   fine level     rows of P of fixed dofs are 0, the smoother skips them
///   coarse levels  A_c = P' A_interior P  +  P' (M B M + W) P
///
/// B being the entries of A in rows or columns of nodes with contact dofs, M the projection that
/// drops the fixed dofs, W what the laws add to tangents. Nothing cancels: what is fixed leaves
/// exact zeros.
class Hierarchy {
 public:
  virtual ~Hierarchy() = default;

  /// Of each contact dof, those from the first contact dof on: fixed, whether it is cut out;
  /// springs (or empty), what is added to its diagonal [force/length].
  virtual void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                        const Vector& springs = {}) = 0;

  /// Of levels alone: carries the unknowns of a border from level to level, as they are, and solves
  /// for them on the coarsest one. From the next truncation on; r and z have n + k entries then.
  virtual void join(const Border& /*border*/) {}

  /// z = one cycle on r (n): two forward Gauss-Seidel sweeps, coarse correction (by two cycles
  /// where that level has coarser ones), two backward sweeps. 0 on fixed dofs, whatever r is there.
  /// Allocates nothing.
  virtual void apply(const Vector& r, Vector& z) = 0;

  /// Ax = A x, neither truncated nor rounded; false where the hierarchy does not keep A: where the
  /// options do not ask for it, with a border, in several processes, and where A is not symmetric
  /// to rounding.
  virtual bool multiply(const Vector& /*x*/, Vector& /*Ax*/) { return false; }

  virtual Index levels() const = 0;
  virtual Real operator_complexity() const = 0;  ///< entries of all levels over those of the fine
  virtual double bytes() const { return 0; }     ///< kept in memory; in one process alone

  /// For tests, or empty: level 0 is the fine one, dense, by slots; prolongation(l) from level l+1
  /// to l.
  virtual Eigen::MatrixXd matrix(Index) const { return {}; }
  virtual Eigen::MatrixXd prolongation(Index) const { return {}; }
};

struct HierarchyOptions {
  bool multiplies = true;  ///< keeps half of A for multiply()
  /// Dofs of a coarse level from which on a dense factorization takes over, which each change of
  /// faces repeats: at 600 a cube of 6591 dofs takes 2.5 times as long, a square of 2738 ten times.
  /// At 60 nothing changes.
  Index coarsest = 150;
  Index dense = 300;  ///< dofs of A up to which one on the fine level itself does
};

/// Where A is small its dense factor, else levels. modes (n x 3 in 2D, n x 6 in 3D): rigid motions,
/// see rigid_modes. A is not kept.
std::unique_ptr<Hierarchy> make_hierarchy(const Matrix& A, const NodeBlocks& blocks,
                                          const Eigen::MatrixXd& modes,
                                          const HierarchyOptions& options = {});

/// The same for a system that tells its mesh nodes and rigid modes; null where it does not, and
/// where a node has more dofs than the dimension: they are no displacements. A system with a border
/// is kept, and has to live as long.
std::unique_ptr<Hierarchy> make_hierarchy(const System& system,
                                          const HierarchyOptions& options = {});

}  // namespace frictioncg
