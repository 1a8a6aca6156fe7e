#pragma once
#include "multigrid/coarsest.h"
#include "multigrid/fine_matrix.h"
#include "multigrid/galerkin.h"
#include "multigrid/hierarchy.h"
#include "multigrid/level.h"

namespace frictioncg {

/// D slots a node on the fine level, K modes a node on the coarse ones.
template <int D, int K>
class HierarchyOf final : public LevelHierarchy {
 public:
  HierarchyOf(const Matrix& A, const NodeBlocks& blocks, const Eigen::MatrixXd& modes,
              const HierarchyOptions& options);
  void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) override;
  void join(const Border& border) override;
  void apply(const Vector& r, Vector& z) override;
  bool multiply(const Vector& x, Vector& Ax) override {
    return exact_.multiply(fine_.A, blocks_.slot, x, Ax);
  }
  Index levels() const override { return static_cast<Index>(1 + coarse_.size()); }
  Real operator_complexity() const override;
  double bytes() const override;
  Eigen::MatrixXd matrix(Index level) const override;
  Eigen::MatrixXd prolongation(Index level) const override;

 private:
  using Fine = Level<D, K>;
  using Coarse = Level<K, K>;
  void build_coarse(Modes<K> modes);
  void set_contact_rows(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                        const Vector& springs);
  void factor_coarsest();
  template <int B>
  void cycle(Level<B, K>& level, std::size_t next);
  void correct(std::size_t next);
  void solve_coarsest(Coarse& level);

  NodeBlocks blocks_;
  HierarchyOptions options_;
  ExactMatrix<D> exact_;
  Real scale_;  ///< brings A near 1
  Fine fine_;
  std::vector<Coarse> coarse_;
  std::vector<float> contact_diagonal_, contact_P_;  ///< of the rows of contact nodes, untruncated
  GalerkinProduct<D, K> fine_product_;
  GalerkinProduct<K, K> product_;
  CoarsestSolver coarsest_;
  DenseMatrix S_;  ///< of the border, scaled; 0 x 0 without one
  Vector x_;       ///< on the coarsest level
};

}  // namespace frictioncg
