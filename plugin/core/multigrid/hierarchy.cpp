#include "multigrid/dense.h"
#include "multigrid/dense_hierarchy.h"
#include "multigrid/hierarchy_of.h"

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

}  // namespace

template <int D, int K>
HierarchyOf<D, K>::HierarchyOf(const Matrix& A, const NodeBlocks& blocks,
                               const Eigen::MatrixXd& modes, const HierarchyOptions& options)
    : blocks_(blocks), options_(options) {
  scale_ = 1 / A.diagonal().mean();
  fine_.A = make_fine_matrix<D>(A, blocks, scale_, exact_);
  if (options.multiplies)
    exact_.keep_if_symmetric(A, fine_.A, blocks.slot);
  else
    exact_ = {};
  for (Index i = 0; i < blocks.blocks; ++i) invert_diagonal(fine_.A, i);
  Modes<K> B = Modes<K>::Zero(blocks.slots(), K);
  for (std::size_t p = 0; p < blocks.slot.size(); ++p) B.row(blocks.slot[p]) = modes.row(p);
  fine_.allocate();
  build_coarse(coarsen<D, K>(fine_, B, coarsening(D, true)));
  contact_diagonal_.assign(fine_.A.diagonal.begin() + std::ptrdiff_t(blocks.interior) * D * D,
                           fine_.A.diagonal.end());
  contact_P_.assign(fine_.P.at(fine_.P.row[blocks.interior]),
                    fine_.P.value.data() + fine_.P.value.size());
  factor_coarsest();
}

template <int D, int K>
void HierarchyOf<D, K>::build_coarse(Modes<K> modes) {
  // on the fine level the contact part is all rows of contact nodes, and their base is 0
  for (Index i = blocks_.interior; i < blocks_.blocks; ++i) {
    fine_.touched.rows.push_back(i);
    for (Index k = fine_.A.row[i]; k < fine_.A.row[i + 1]; ++k) fine_.touched.lower.push_back(k);
    fine_.touched.begin.push_back(static_cast<Index>(fine_.touched.lower.size()));
  }
  std::vector<float> contact = fine_.touched.read(fine_.A);
  fine_.base.assign(contact.size(), 0);
  coarse_.emplace_back();
  make_next<D, K>(fine_, coarse_.back(), contact);
  std::vector<float>().swap(fine_.base);
  while (coarse_.back().A.rows() * K > options_.coarsest) {
    Coarse& level = coarse_.back();
    modes = coarsen<K, K>(level, modes, coarsening(D, false));
    if (level.P.columns > stalled * level.A.rows()) break;
    Coarse next;
    make_next<K, K>(level, next, contact);
    coarse_.push_back(std::move(next));
  }
}

/// Diagonal blocks, their inverses and the prolongation at the contact nodes.
template <int D, int K>
void HierarchyOf<D, K>::set_contact_rows(const std::vector<char>& fixed,
                                         const std::vector<TangentialStiffness>& W,
                                         const Vector& springs) {
  const Index first_contact = static_cast<Index>(blocks_.slot.size() - fixed.size());
  const Index first_slot = D * blocks_.interior;
  std::vector<char> out(std::size_t(blocks_.slots() - first_slot), 0);
  for (std::size_t c = 0; c < fixed.size(); ++c)
    out[blocks_.slot[first_contact + c] - first_slot] = fixed[c];

  float* diagonal = fine_.A.diagonal.data() + std::size_t(blocks_.interior) * D * D;
  std::copy(contact_diagonal_.begin(), contact_diagonal_.end(), diagonal);
  for (Eigen::Index c = 0; c < springs.size(); ++c) {
    const Index p = blocks_.slot[first_contact + c];
    diagonal[std::size_t(p - first_slot) * D + p % D] += static_cast<float>(scale_ * springs[c]);
  }
  for (const TangentialStiffness& w : W)
    for (int k = 0; k < 2; ++k)
      for (int l = 0; l < 2; ++l) {
        const Index p = blocks_.slot[w.first + k], q = blocks_.slot[w.first + l];
        diagonal[std::size_t(p - first_slot) * D + q % D] += static_cast<float>(scale_ * w.M(k, l));
      }
  std::copy(contact_P_.begin(), contact_P_.end(), fine_.P.at(fine_.P.row[blocks_.interior]));
  for (std::size_t s = 0; s < out.size(); ++s) {
    if (!out[s]) continue;
    const Index i = blocks_.interior + static_cast<Index>(s / D);
    const int place = static_cast<int>(s % D);
    for (int k = 0; k < D; ++k)
      fine_.A.diagonal_at(i)[place * D + k] = fine_.A.diagonal_at(i)[k * D + place] = 0;
    for (Index q = fine_.P.row[i]; q < fine_.P.row[i + 1]; ++q)
      std::fill(fine_.P.at(q) + place * K, fine_.P.at(q) + (place + 1) * K, 0.0f);
  }
  for (Index i = blocks_.interior; i < blocks_.blocks; ++i) invert_diagonal(fine_.A, i);
}

template <int D, int K>
void HierarchyOf<D, K>::truncate(const std::vector<char>& fixed,
                                 const std::vector<TangentialStiffness>& W, const Vector& springs) {
  set_contact_rows(fixed, W, springs);
  coarse_.front().touched.clear(coarse_.front().A);
  fine_product_.add(fine_.A, fine_.P, fine_.touched, coarse_.front().A);
  for (std::size_t l = 0; l < coarse_.size(); ++l) {
    Coarse& level = coarse_[l];
    if (l + 1 < coarse_.size()) {
      Coarse& next = coarse_[l + 1];
      next.touched.clear(next.A);
      product_.add(level.A, level.P, level.touched, next.A);
    }
    level.touched.add(1, level.base, level.A);
    for (const Index i : level.touched.rows) invert_diagonal(level.A, i);
  }
  restrict_border(fine_.P, fine_.border, coarse_.front().border);
  for (std::size_t l = 0; l + 1 < coarse_.size(); ++l)
    restrict_border(coarse_[l].P, coarse_[l].border, coarse_[l + 1].border);
  factor_coarsest();
}

template <int D, int K>
void HierarchyOf<D, K>::join(const Border& border) {
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

template <int D, int K>
void HierarchyOf<D, K>::factor_coarsest() {
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
  coarsest_.factor(std::move(A), shift);
}

template <int D, int K>
Real HierarchyOf<D, K>::operator_complexity() const {
  const auto entries = [](const auto& A) {
    return 2.0 * double(A.value.size()) + double(A.diagonal.size());
  };
  Real sum = entries(fine_.A);
  for (const Coarse& level : coarse_) sum += entries(level.A);
  return sum / entries(fine_.A);
}

template <int D, int K>
double HierarchyOf<D, K>::bytes() const {
  double sum = fine_.bytes() + exact_.bytes() +
               sizeof(Index) * double(blocks_.slot.size() + blocks_.dof.size());
  for (const Coarse& level : coarse_) sum += level.bytes();
  return sum + coarsest_.bytes();
}

template <int D, int K>
Eigen::MatrixXd HierarchyOf<D, K>::matrix(Index level) const {
  return level == 0 ? dense(fine_.A) : dense(coarse_[level - 1].A);
}

template <int D, int K>
Eigen::MatrixXd HierarchyOf<D, K>::prolongation(Index level) const {
  return level == 0 ? dense(fine_.P) : dense(coarse_[level - 1].P);
}

std::unique_ptr<LevelHierarchy> make_levels(const Matrix& A, const NodeBlocks& blocks,
                                            const Eigen::MatrixXd& modes,
                                            const HierarchyOptions& options) {
  if (blocks.size == 2) return std::make_unique<HierarchyOf<2, 3>>(A, blocks, modes, options);
  return std::make_unique<HierarchyOf<3, 6>>(A, blocks, modes, options);
}

std::unique_ptr<Hierarchy> make_hierarchy(const Matrix& A, const NodeBlocks& blocks,
                                          const Eigen::MatrixXd& modes,
                                          const HierarchyOptions& options) {
  if (blocks.dofs() <= options.dense) return std::make_unique<DenseHierarchy>(A);
  return make_levels(A, blocks, modes, options);
}

}  // namespace frictioncg
