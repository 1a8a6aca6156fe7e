#include "condensed/elimination.h"

#include "clock.h"
#include "statics/floating.h"
#include "threads.h"

namespace frictioncg {

namespace {

constexpr Real sigma = 0.5;        ///< of the springs, in units of D: costs S one digit
constexpr Real most_shift = 100;   ///< of the contact dofs, where A has negative energy
constexpr int dense_matrices = 3;  ///< S, the matrix of a Newton step, and what solves it
/// Over D: below it a pivot may be the rounding of 0. A motion that moves the last dof by v leaves
/// pivots of v^2 and of rounding/v^2, the least of them at most 1e-8.
constexpr Real small_pivot = 1e-6;
constexpr Index most_motions = 6;  ///< of one body
constexpr Index panel_width = 64;

/// The contact dofs, last, get the shift, and are chained: so each is the parent of the one before
/// in the elimination tree. roots: as in Elimination.
UpperTriangle triangle_of(const System& s, const std::vector<Index>& roots) {
  std::vector<char> chained(s.dofs(), 0);
  std::fill(chained.begin() + std::min(s.interior() + 1, s.dofs()), chained.end(), 1);
  UpperTriangle A(s, chained, roots);
  for (Index j = s.interior(); j < s.dofs(); ++j) A.diagonal(j) += sigma * s.D[j];
  return A;
}

/// The arrays of a supernodal factor, by CHOLMOD's names.
struct Supernodes {
  const Index *super, *pi, *px, *s;
  Real* x;
};
Supernodes supernodes_of(const cholmod_factor& L) {
  return {static_cast<Index*>(L.super), static_cast<Index*>(L.pi), static_cast<Index*>(L.px),
          static_cast<Index*>(L.s), static_cast<Real*>(L.x)};
}

}  // namespace

Elimination::Outcome Elimination::factor(const System& system, double memory_bound) {
  const bool laid_out = std::exchange(laid_out_, false);
  if (!laid_out) release();
  times_ = {};
  n_ = system.dofs();
  interior_ = system.interior();
  const double contact = system.contact_dofs();
  memory_needed_ = dense_matrices * sizeof(Real) * contact * contact;
  if (memory_needed_ > memory_bound) return Outcome::too_large;

  double start = cpu_seconds();
  if (!laid_out) roots_.clear();
  UpperTriangle A = triangle_of(system, roots_);
  if (!laid_out) {
    if (!analyze(system, A)) return Outcome::too_large;
    times_.order = cpu_seconds() - start;
    start += times_.order;
  }
  memory_needed_ += sizeof(Real) * double(L_->xsize);
  if (memory_needed_ > memory_bound) return Outcome::too_large;

  const Threads threads(threads_pay());
  DenseMatrix known(n_, 0);
  if (!factorize(system, A, known) || !find_floating(system, known))
    return Outcome::not_positive_definite;
  times_.factor = cpu_seconds() - start;

  start = cpu_seconds();
  form_S(system.D.tail(system.contact_dofs()));
  times_.condense = cpu_seconds() - start;
  laid_out_ = true;
  return Outcome::done;
}

/// Orders the dofs and lays out the factor. False where it is too large for CHOLMOD.
bool Elimination::analyze(const System& system, UpperTriangle& A) {
  const std::vector<Index> order = contact_last(system, common_);
  const auto fits = [&] {
    if (lay_out(A.view, order)) return true;
    memory_needed_ = std::numeric_limits<double>::infinity();
    return false;
  };
  if (!fits()) return false;
  if (contact_is_last()) return true;
  // Several bodies: a postordering may end one body, its contact included, before the next.
  roots_ = last_of_each_part(system, order);
  A = triangle_of(system, roots_);
  if (!fits()) return false;
  if (!contact_is_last())
    throw std::logic_error("elimination: the contact dofs are not last in the factor");
  return true;
}

/// Factors A, with a greater shift where bodies that contact presses have negative energy without
/// it, and springs where the interior alone is singular. False where that is not what keeps A from
/// being factored. Of the motions that are known springs stand where they tell them best, of others
/// where a pivot fails: after many of these rounding takes one motion for another.
bool Elimination::factorize(const System& system, UpperTriangle& A, DenseMatrix& known) {
  springs_.clear();
  shift_ = sigma;
  const auto hold = [&](Index i) {
    springs_.push_back(i);
    A.diagonal(i) += sigma * system.D[i];  // a spring to the ground
  };
  std::size_t most_springs = 0;
  for (;;) {
    const bool failed = !SparseFactor::factorize(A.view);
    const Index* place = static_cast<const Index*>(L_->Perm);
    Index i = failed ? place[L_->minor] : dof_of_smallest_pivot(system);
    if (!failed && i < 0) return true;
    if (i >= interior_ && shift_ < most_shift) {
      for (Index c = interior_; c < n_; ++c) A.diagonal(c) += 3 * shift_ * system.D[c];
      shift_ *= 4;
      continue;
    }
    if (!failed) {  // is it the rounding of 0?
      const Vector v = solve(CHOLMOD_A, Vector::Unit(n_, i));
      if (!costs_no_energy(system, v)) return true;
      system.D.cwiseProduct(v.cwiseAbs2()).head(interior_).maxCoeff(&i);
    }
    if (springs_.empty()) {
      known = motions_of_interior(floating_motions(system), interior_);
      for (Index told : telling_rows(system.D.cwiseSqrt().asDiagonal() * known)) hold(told);
      if (!springs_.empty()) continue;
    }
    if (most_springs == 0) {
      const std::size_t parts = last_of_each_part(system, {place, place + n_}).size(),
                        of_bodies = system.body_modes ? system.body_modes().cols() : 0;
      most_springs = system.border.cols() + std::max(most_motions * parts, of_bodies);
    }
    if (i >= interior_ || springs_.size() == most_springs) return false;
    hold(i);
  }
}

/// The interior dof without a spring whose pivot is least, over D; -1 where none is small.
Index Elimination::dof_of_smallest_pivot(const System& system) const {
  const auto [super, pi, px, s, x] = supernodes_of(*L_);
  const Index* place = static_cast<Index*>(L_->Perm);
  Real least = small_pivot;
  Index found = -1;
  for (std::size_t k = 0; k < L_->nsuper; ++k)
    for (Index j = super[k]; j < super[k + 1] && j < interior_; ++j) {
      const Real l = x[px[k] + (j - super[k]) * (pi[k + 1] - pi[k] + 1)];
      const Real pivot = l * l / system.D[place[j]];
      if (pivot >= least) continue;
      least = pivot;
      found = place[j];
    }
  return found;
}

/// The motions that the springs stand in for: those that are known, which beside a body 1e6 times
/// as stiff have more digits than a solution. False where one of others costs energy.
bool Elimination::find_floating(const System& system, const DenseMatrix& known) {
  floating_ = one_for_each(springs_, known);
  if (floating_.cols() > 0 || springs_.empty()) return true;
  floating_.resize(n_, springs_.size());
  for (std::size_t k = 0; k < springs_.size(); ++k) {
    const Index i = springs_[k];
    Vector v = solve(CHOLMOD_A, sigma * system.D[i] * Vector::Unit(n_, i));
    v.tail(n_ - interior_).setZero();
    if (!costs_no_energy(system, v)) return false;
    floating_.col(k) = v;
  }
  return true;
}

bool Elimination::contact_is_last() const {
  for (Index i = interior_; i < n_; ++i)
    if (static_cast<const Index*>(L_->Perm)[i] != i) return false;
  return true;
}

/// Visits the entries (row, column, value) of L_CC, by the supernodes that end in the contact dofs.
template <class Visit>
void Elimination::for_each_trailing(Visit visit) const {
  const auto [super, pi, px, s, x] = supernodes_of(*L_);
  for (Index k = static_cast<Index>(L_->nsuper) - 1; k >= 0 && super[k + 1] > interior_; --k) {
    const Index rows = pi[k + 1] - pi[k];
    for (Index j = std::max(super[k], interior_); j < super[k + 1]; ++j)
      for (Index q = j - super[k]; q < rows; ++q)
        visit(s[pi[k] + q] - interior_, j - interior_, x[px[k] + q + (j - super[k]) * rows]);
  }
}

/// S = L_CC L_CC' - shift D_CC, supernode by supernode in panels of rows, the lower half; then the
/// other half.
void Elimination::form_S(const Vector& D_C) {
  S_.setZero(n_ - interior_, n_ - interior_);
  const auto [super, pi, px, s, x] = supernodes_of(*L_);
  DenseMatrix panel, product;
  for (Index k = static_cast<Index>(L_->nsuper) - 1; k >= 0 && super[k + 1] > interior_; --k) {
    const Index first = std::max(super[k], interior_) - super[k], all = pi[k + 1] - pi[k];
    const Index columns = super[k + 1] - super[k] - first, rows = all - first;
    const Index* place = s + pi[k] + first;  // of the rows, contact dofs only
    const Eigen::Map<const DenseMatrix, 0, Eigen::OuterStride<>> L(
        x + px[k] + first * (all + 1), rows, columns, Eigen::OuterStride<>(all));
    for (Index begin = 0; begin < rows; begin += panel_width) {
      const Index height = std::min(panel_width, rows - begin);
      const Index depth = std::min(begin + height, columns);
      panel = L.block(begin, 0, height, depth);
      for (Index j = begin + 1; j < depth; ++j) panel.col(j).head(j - begin).setZero();
      product.resize(rows - begin, height);
      product.topRows(height).noalias() = panel * panel.transpose();
      product.bottomRows(rows - begin - height).noalias() =
          L.block(begin + height, 0, rows - begin - height, depth) * panel.transpose();
      for (Index j = 0; j < height; ++j)
        for (Index i = j; i < rows - begin; ++i)
          S_(place[begin + i] - interior_, place[begin + j] - interior_) += product(i, j);
    }
  }
  S_.diagonal() -= shift_ * D_C;
  S_.triangularView<Eigen::StrictlyUpper>() = S_.transpose();
}

Vector Elimination::condense(const Vector& F) {
  y_ = solve(CHOLMOD_L, solve(CHOLMOD_P, F));
  Vector f = Vector::Zero(n_ - interior_);
  for_each_trailing([&](Index i, Index j, Real l) { f[i] += l * y_[interior_ + j]; });
  return f;
}

/// P' L^{-T} y with y_C := L_CC' x_C.
Vector Elimination::back_substitute(Vector y, const Vector& x_C) {
  y.tail(n_ - interior_).setZero();
  for_each_trailing([&](Index i, Index j, Real l) { y[interior_ + j] += l * x_C[i]; });
  return solve(CHOLMOD_Pt, solve(CHOLMOD_Lt, y));
}

}  // namespace frictioncg
