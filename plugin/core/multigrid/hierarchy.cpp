#include <Eigen/Cholesky>

#include "linear_algebra.h"
#include "multigrid/exact_matrix.h"
#include "multigrid/hierarchy.h"
#include "multigrid/level.h"
#include "multigrid/smoother.h"

namespace frictioncg {

namespace {

/// The coarsest matrix gets this share of its diagonal in addition: single precision rounds by as
/// much, and motions that nothing holds would make it singular.
constexpr Real shift = 1e-6;
/// A coarsening that leaves more than this share of the rows is not worth a level.
constexpr Real stalled = 0.8;
/// A coarsest level of more dofs, which no coarsening made smaller, is smoothed and not factored.
constexpr std::size_t most = 4000;

/// Thin layers of elements (aspect 10: couplings of 0.01 beside 1) are not to be aggregated across;
/// in 2D, where an aggregate has fewer neighbours, nor those of half that aspect.
/// Smoothed prolongations widen the graph of coarse levels: there, only the stronger half of the
/// couplings counts.
Coarsening coarsening(int dimension, bool fine) {
  if (fine) return dimension == 2 ? Coarsening{0.15f, 5} : Coarsening{0.08f, 15};
  return dimension == 2 ? Coarsening{0.25f, 4} : Coarsening{0.25f, 8};
}

using Factor = Eigen::LLT<Eigen::MatrixXd>;

/// The factor of A, symmetric positive semi-definite; rows of 0 get the solution r itself. A kernel
/// is shifted away: by `least` of the diagonal, or tenfold as often as it takes.
void factor_shifted(Eigen::MatrixXd A, Real least, Factor& factor) {
  const Vector diagonal = A.diagonal();
  for (Real s = least; s < 1; s *= 10) {
    for (Eigen::Index k = 0; k < diagonal.size(); ++k)
      A(k, k) = diagonal[k] > 0 ? (1 + s) * diagonal[k] : 1;
    factor.compute(A);
    if (factor.info() == Eigen::Success) break;
  }
}

/// D slots a node on the fine level, K modes a node on the coarse ones.
template <int D, int K>
class HierarchyOf final : public Hierarchy {
 public:
  HierarchyOf(const Matrix& A, const NodeBlocks& blocks, const Eigen::MatrixXd& modes,
              const HierarchyOptions& options)
      : blocks_(blocks), scale_(1 / A.diagonal().mean()) {
    fine_.A = make_fine_matrix<D>(A, blocks, scale_, exact_);
    if (options.multiplies)
      exact_.keep_if_symmetric(A, fine_.A, blocks.slot);
    else
      exact_ = {};
    for (Index i = 0; i < blocks.blocks; ++i) invert_diagonal(fine_.A, i);
    Modes<K> B = Modes<K>::Zero(blocks.slots(), K);
    for (std::size_t p = 0; p < blocks.slot.size(); ++p) B.row(blocks.slot[p]) = modes.row(p);
    fine_.allocate();
    build_coarse(fine_.coarsen(B, blocks.place, coarsening(D, true)), options.coarsest);
    blocks_.place.resize(0, 0);
    for (const Index i : blocks.contact) {
      contact_diagonal_.insert(contact_diagonal_.end(), fine_.A.diagonal_at(i),
                               fine_.A.diagonal_at(i + 1));
      contact_P_.insert(contact_P_.end(), fine_.P.at(fine_.P.row[i]),
                        fine_.P.at(fine_.P.row[i + 1]));
    }
    factor_coarsest();
  }

  void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) override {
    set_contact_rows(fixed, W, springs);
    fine_.restrict_touched(fine_product_, coarse_.front());
    for (std::size_t l = 0; l < coarse_.size(); ++l) {
      Coarse& level = coarse_[l];
      if (l + 1 < coarse_.size()) level.restrict_touched(product_, coarse_[l + 1]);
      level.touched.add(1, level.base, level.A);
      for (const Index i : level.touched.rows) invert_diagonal(level.A, i);
    }
    factor_coarsest();
  }

  void join(const Border& border) override {
    LevelBorder<D>& fine = fine_.border;
    S_ = scale_ * border.S;
    std::vector<Index> at(blocks_.blocks, -1);
    fine.block.clear();
    for (const Index p : border.row) {
      const Index i = blocks_.slot[p] / D;
      if (at[i] >= 0) continue;
      at[i] = static_cast<Index>(fine.block.size());
      fine.block.push_back(i);
    }
    fine.B.setZero(Eigen::Index(fine.block.size()) * D, S_.cols());
    for (std::size_t b = 0; b < border.row.size(); ++b) {
      const Index slot = blocks_.slot[border.row[b]];
      fine.B.row(at[slot / D] * D + slot % D) =
          (scale_ * border.B.row(Eigen::Index(b))).template cast<float>();
    }
    fine.allocate(S_.cols());
    for (Coarse& level : coarse_) level.border.allocate(S_.cols());
  }

  void apply(const Vector& r, Vector& z) override {
    const Real size = r.lpNorm<Eigen::Infinity>();
    z.resize(r.size());
    if (!(size > 0)) {
      z.setZero();
      return;
    }
    // to order 1 and back: single precision keeps its range
    const Eigen::Index k = S_.cols();
    const auto at = [this](Index p) {
      const std::size_t slot = blocks_.slot[p];
      return slot / D * stride<D> + slot % D;
    };
    in_ranges(blocks_.dofs(), [&](Index first, Index end) {
      for (Index p = first; p < end; ++p) fine_.r[at(p)] = static_cast<float>(r[p] / size);
    });
    fine_.border.r = r.tail(k) / size;
    cycle(fine_, 0);
    in_ranges(blocks_.dofs(), [&](Index first, Index end) {
      for (Index p = first; p < end; ++p) z[p] = size * scale_ * fine_.z[at(p)];
    });
    z.tail(k) = size * scale_ * fine_.border.z;
  }

  bool multiply(const Vector& x, Vector& Ax) override {
    return exact_.multiply(fine_.A, blocks_.slot, x, Ax);
  }
  Index levels() const override { return static_cast<Index>(1 + coarse_.size()); }

  Real operator_complexity() const override {
    const auto entries = [](const auto& A) {
      return 2.0 * double(A.value.size()) + double(A.diagonal.size());
    };
    Real sum = entries(fine_.A);
    for (const Coarse& level : coarse_) sum += entries(level.A);
    return sum / entries(fine_.A);
  }

  double bytes() const override {
    double sum = fine_.bytes() + exact_.bytes() + bytes_of(blocks_.slot, blocks_.dof) +
                 sizeof(Real) * double(coarsest_.rows()) * double(coarsest_.cols());
    for (const Coarse& level : coarse_) sum += level.bytes();
    return sum;
  }

  Eigen::MatrixXd matrix(Index level) const override {
    return level == 0 ? dense(fine_.A) : dense(coarse_[level - 1].A);
  }

  Eigen::MatrixXd prolongation(Index level) const override {
    return level == 0 ? dense(fine_.P) : dense(coarse_[level - 1].P);
  }

 private:
  using Coarse = Level<K, K>;

  void build_coarse(Grid<K> grid, Index coarsest) {
    // on the fine level the contact part is all rows and columns of contact nodes, and the diagonal
    // blocks of rows that have such columns; their base is 0
    std::vector<char> touches(blocks_.blocks, 0);
    for (const Index i : blocks_.contact) touches[i] = 1;
    for (Index i = 0; i < blocks_.blocks; ++i) {
      for (Index k = fine_.A.row[i]; k < fine_.A.row[i + 1]; ++k)
        if (touches[i] || touches[fine_.A.col[k]]) fine_.touched.lower.push_back(k);
      const Index end = static_cast<Index>(fine_.touched.lower.size());
      if (!touches[i] && end == fine_.touched.begin.back()) continue;
      fine_.touched.rows.push_back(i);
      fine_.touched.begin.push_back(end);
    }
    std::vector<float> contact = fine_.touched.read(fine_.A);
    fine_.base.assign(contact.size(), 0);
    coarse_.emplace_back();
    fine_.make_next(coarse_.back(), grid, contact);
    std::vector<float>().swap(fine_.base);
    while (coarse_.back().A.rows() * K > coarsest) {
      Coarse& level = coarse_.back();
      grid = level.coarsen(grid.modes, grid.place, coarsening(D, false));
      if (level.P.columns > stalled * level.A.rows()) break;
      Coarse next;
      level.make_next(next, grid, contact);
      coarse_.push_back(std::move(next));
    }
  }

  /// Diagonal blocks, their inverses and the prolongation at the contact nodes.
  void set_contact_rows(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                        const Vector& springs) {
    const Index first_contact = static_cast<Index>(blocks_.slot.size() - fixed.size());
    const float *diagonal = contact_diagonal_.data(), *P = contact_P_.data();
    for (const Index i : blocks_.contact) {
      const std::ptrdiff_t entries = std::ptrdiff_t(fine_.P.row[i + 1] - fine_.P.row[i]) * D * K;
      std::copy_n(diagonal, D * D, fine_.A.diagonal_at(i));
      std::copy_n(P, entries, fine_.P.at(fine_.P.row[i]));
      diagonal += D * D;
      P += entries;
    }
    const auto add = [&](Index i, Index j, Real stiffness) {  // of dofs of one node
      const Index p = blocks_.slot[i], q = blocks_.slot[j];
      fine_.A.diagonal_at(p / D)[p % D * D + q % D] += static_cast<float>(scale_ * stiffness);
    };
    for (Index c = 0; c < springs.size(); ++c)
      add(first_contact + c, first_contact + c, springs[c]);
    for (const TangentialStiffness& w : W)
      for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l) add(w.first + k, w.first + l, w.M(k, l));
    for (std::size_t c = 0; c < fixed.size(); ++c) {
      if (!fixed[c]) continue;
      const Index slot = blocks_.slot[first_contact + c], i = slot / D, place = slot % D;
      for (int k = 0; k < D; ++k)
        fine_.A.diagonal_at(i)[place * D + k] = fine_.A.diagonal_at(i)[k * D + place] = 0;
      for (Index q = fine_.P.row[i]; q < fine_.P.row[i + 1]; ++q)
        std::fill(fine_.P.at(q) + place * K, fine_.P.at(q) + (place + 1) * K, 0.0f);
    }
    for (const Index i : blocks_.contact) invert_diagonal(fine_.A, i);
  }

  void factor_coarsest() {
    const Coarse& level = coarse_.back();
    const Eigen::Index n = Eigen::Index(level.A.rows()) * K, k = S_.cols();
    if (std::size_t(n) > most) return;
    x_.resize(n + k);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + k, n + k);
    A.topLeftCorner(n, n) = matrix(levels() - 1);
    A.bottomRightCorner(k, k) = S_;
    for (std::size_t b = 0; b < level.border.block.size(); ++b) {
      const Eigen::Index first = Eigen::Index(level.border.block[b]) * K;
      A.block(first, n, K, k) =
          level.border.B.template middleRows<K>(Eigen::Index(b) * K).template cast<Real>();
      A.block(n, first, k, K) = A.block(first, n, K, k).transpose();
    }
    factor_shifted(std::move(A), shift, coarsest_);
  }

  /// level.z from level.r: two sweeps, correction from the level next, two sweeps.
  template <int B>
  void cycle(Level<B, K>& level, std::size_t next) {
    level.residual = level.r;
    sweep_forward(level.A, level.residual.data(), level.z.data());
    sweep_forward(level.A, level.residual.data(), level.work.data());
    for (std::size_t k = 0; k < level.z.size(); ++k) level.z[k] += level.work[k];
    restrict_to(level.P, level.residual.data(), coarse_[next].r, sums_);
    coarse_[next].border.r = level.border.r;
    level.border.subtract_transposed(level.z.data(), coarse_[next].border.r);
    correct(next);
    prolong(level.P, coarse_[next].z.data(), level.z.data());
    level.border.z = coarse_[next].border.z;
    for (int sweep = 0; sweep < 2; ++sweep) {
      level.work = level.r;
      level.border.subtract(level.border.z, level.work.data());
      sweep_backward(level.A, level.work.data(), level.z.data());
    }
  }

  /// coarse.z from coarse.r: exact on the coarsest level, elsewhere by two cycles.
  void correct(std::size_t next) {
    Coarse& coarse = coarse_[next];
    if (next + 1 == coarse_.size()) {
      solve_coarsest(coarse);
      return;
    }
    LevelBorder<K>& q = coarse.border;
    cycle(coarse, next + 1);
    coarse.r.swap(coarse.first_r);
    coarse.z.swap(coarse.first_z);
    q.r.swap(q.first_r);
    q.z.swap(q.first_z);
    subtract_product(coarse.A, coarse.first_r.data(), coarse.first_z.data(), coarse.r.data());
    q.subtract(q.first_z, coarse.r.data());
    q.r = q.first_r - S_.lazyProduct(q.first_z);
    q.subtract_transposed(coarse.first_z.data(), q.r);
    cycle(coarse, next + 1);
    q.z += q.first_z;
    for (std::size_t k = 0; k < coarse.z.size(); ++k) coarse.z[k] += coarse.first_z[k];
  }

  void solve_coarsest(Coarse& level) {
    LevelBorder<K>& q = level.border;
    if (x_.size() > 0) {
      const Eigen::Index rows = level.A.rows();
      const auto slots = [&](std::vector<float>& v) {
        return Eigen::Map<Eigen::MatrixXf, 0, Eigen::OuterStride<stride<K>>>(v.data(), K, rows);
      };
      x_.head(rows * K).reshaped(K, rows) = slots(level.r).template cast<Real>();
      x_.tail(q.r.size()) = q.r;
      coarsest_.solveInPlace(x_);
      slots(level.z) = x_.head(rows * K).reshaped(K, rows).template cast<float>();
      q.z = x_.tail(q.z.size());
      return;
    }
    level.work = level.r;
    sweep_forward(level.A, level.work.data(), level.z.data());
    level.work = level.r;
    if (S_.size() > 0) {
      q.subtract_transposed(level.z.data(), q.r);
      q.z = solve(S_, q.r);
      q.subtract(q.z, level.work.data());
    }
    sweep_backward(level.A, level.work.data(), level.z.data());
  }

  NodeBlocks blocks_;
  ExactMatrix<D> exact_;
  const Real scale_;  ///< brings A near 1
  Level<D, K> fine_;
  std::vector<Coarse> coarse_;
  std::vector<float> contact_diagonal_, contact_P_;  ///< of the rows of contact nodes, untruncated
  GalerkinProduct<D, K> fine_product_;
  GalerkinProduct<K, K> product_;
  Factor coarsest_;
  DenseMatrix S_;            ///< of the border, scaled; 0 x 0 without one
  Vector x_;                 ///< on the coarsest level, where that is factored
  std::vector<float> sums_;  ///< for restrict_to()
};

/// A hierarchy of one level: a small matrix, factored with each set of faces in double precision.
/// Whatever its conditioning, it needs no coarse space.
class DenseHierarchy final : public Hierarchy {
 public:
  explicit DenseHierarchy(const Matrix& A) : A_(A) { truncate({}, {}, {}); }

  void truncate(const std::vector<char>& fixed, const std::vector<TangentialStiffness>& W,
                const Vector& springs) override {
    const Eigen::Index interior = A_.rows() - Eigen::Index(fixed.size());
    fixed_ = fixed;
    Eigen::MatrixXd A = A_;
    A.diagonal().tail(springs.size()) += springs;
    for (const TangentialStiffness& w : W) A.block<2, 2>(w.first, w.first) += w.M;
    for (std::size_t c = 0; c < fixed.size(); ++c)
      if (fixed[c]) {
        A.row(interior + Eigen::Index(c)).setZero();
        A.col(interior + Eigen::Index(c)).setZero();
      }
    factor_shifted(std::move(A), far_above_rounding, factor_);
  }
  void apply(const Vector& r, Vector& z) override {
    z = r;
    factor_.solveInPlace(z);
    drop_fixed(fixed_, z);
  }
  Index levels() const override { return 1; }
  Real operator_complexity() const override { return 1; }
  double bytes() const override { return 2.0 * sizeof(Real) * double(A_.size()); }

 private:
  static constexpr Real far_above_rounding = 1e-10;  ///< and far below A
  const Eigen::MatrixXd A_;
  std::vector<char> fixed_;
  Factor factor_;
};

}  // namespace

std::unique_ptr<Hierarchy> make_hierarchy(const Matrix& A, const NodeBlocks& blocks,
                                          const Eigen::MatrixXd& modes,
                                          const HierarchyOptions& options) {
  if (blocks.dofs() <= options.dense) return std::make_unique<DenseHierarchy>(A);
  if (blocks.size == 2) return std::make_unique<HierarchyOf<2, 3>>(A, blocks, modes, options);
  return std::make_unique<HierarchyOf<3, 6>>(A, blocks, modes, options);
}

}  // namespace frictioncg
