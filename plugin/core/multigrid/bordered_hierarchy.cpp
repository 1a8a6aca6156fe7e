#include "multigrid/bordered_hierarchy.h"

#include <algorithm>

namespace frictioncg {

namespace {
/// S gets this share of the border's D in addition: an obstacle that no face holds makes it
/// singular, and one that a single node holds is softer than D by their number.
constexpr Real shift = 1e-10;
/// How the bodies follow is found anew unless so many contact dofs changed, over those fixed: then
/// the next truncation changes as many. On a sphere (52 k dofs, 1 to 6 motions) that takes 25 to 28
/// cycles in place of the 21 of a sphere that stands still; with a pass each time one or two fewer,
/// with none 39 to 52.
constexpr Real many = 1;
}  // namespace

BorderedHierarchy::BorderedHierarchy(const System& system, std::unique_ptr<Hierarchy> bodies)
    : system_(system),
      bodies_(std::move(bodies)),
      first_(system.interior() - static_cast<Index>(system.border.cols())),
      border_(static_cast<Index>(system.border.cols())),
      fixed_(system.contact_dofs(), 1),
      Z_(DenseMatrix::Zero(system.dofs(), border_)),
      AZ_(DenseMatrix::Zero(system.dofs(), border_)) {
  for (Index p = 0; p < system.interior(); ++p)
    for (Matrix::InnerIterator e(system.border, p); e; ++e) Z_(p, e.col()) = e.value();
  for (Index k = 0; k < border_; ++k) {
    system_.multiply(Z_.col(k), y_);
    AZ_.col(k) = y_;
  }
}

/// What is fixed now goes with the obstacle; what was fixed stays where it is. Returns how many
/// contact dofs change.
Index BorderedHierarchy::fix(const std::vector<char>& fixed) {
  const Index contact = static_cast<Index>(fixed.size());
  Index changed = 0;
  const DenseMatrix before = Z_.bottomRows(contact);
  for (Index c = 0; c < contact; ++c) {
    if (fixed[c] == fixed_[c]) continue;
    ++changed;
    Z_.row(system_.interior() + c).setZero();
    if (fixed[c]) continue;
    for (Matrix::InnerIterator e(system_.border, system_.interior() + c); e; ++e)
      Z_(system_.interior() + c, e.col()) = e.value();
  }
  fixed_ = fixed;
  for (Index k = 0; k < border_ && changed > 0; ++k) {
    y_ = AZ_.col(k);
    system_.move_contact(before.col(k) - Z_.col(k).tail(contact), y_);
    AZ_.col(k) = y_;
  }
  return changed;
}

/// One cycle on each column of AZ.
void BorderedHierarchy::follow() {
  for (Index k = 0; k < border_; ++k) {
    cycle(T_.col(k), y_);
    Z_.col(k) -= y_;
    system_.multiply(y_, rest_);
    AZ_.col(k) -= rest_;
  }
}

/// T = AZ, of the truncated A, and S.
void BorderedHierarchy::form(const std::vector<TangentialStiffness>& W, const Vector& springs) {
  T_ = AZ_;
  T_.bottomRows(springs.size()) += springs.asDiagonal() * Z_.bottomRows(springs.size());
  for (const TangentialStiffness& w : W)
    T_.middleRows(w.first, 2) += w.M * Z_.middleRows(w.first, 2);
  for (std::size_t c = 0; c < fixed_.size(); ++c)
    if (fixed_[c]) T_.row(system_.interior() + static_cast<Index>(c)).setZero();
  S_ = Z_.transpose().lazyProduct(T_);
  S_.diagonal() += shift * system_.D.segment(first_, border_);
}

void BorderedHierarchy::truncate(const std::vector<char>& fixed,
                                 const std::vector<TangentialStiffness>& W, const Vector& springs) {
  std::vector<TangentialStiffness> of_bodies = W;
  for (TangentialStiffness& w : of_bodies) w.first -= border_;
  bodies_->truncate(fixed, of_bodies, springs);
  const Index changed = fix(fixed);
  form(W, springs);
  const Real held = static_cast<Real>(std::count(fixed.begin(), fixed.end(), 1));
  if (changed == 0 || changed > many * held) return;
  follow();
  form(W, springs);
}

/// y = H r on v, 0 on q
void BorderedHierarchy::cycle(const Vector& r, Vector& y) {
  const Index behind = static_cast<Index>(r.size()) - first_ - border_;
  r_v_.resize(first_ + behind);
  r_v_ << r.head(first_), r.tail(behind);
  bodies_->apply(r_v_, z_v_);
  y.resize(r.size());
  y << z_v_.head(first_), Vector::Zero(border_), z_v_.tail(behind);
}

void BorderedHierarchy::apply(const Vector& r, Vector& z) {
  const Vector t = solve(S_, Z_.transpose() * r);
  rest_ = r - T_ * t;
  cycle(rest_, z);
  z += Z_ * (t - solve(S_, T_.transpose() * z));
}

double BorderedHierarchy::bytes() const {
  return bodies_->bytes() + sizeof(Real) * double(Z_.size() + AZ_.size() + T_.size());
}

Matrix without_border(const System& system) {
  const Index k = static_cast<Index>(system.border.cols()), n = system.dofs();
  const Index end = system.interior(), first = end - k;
  Matrix A(n - k, n - k);
  A.reserve(system.A.nonZeros());
  for (Index p = 0; p < n; ++p) {
    if (p >= first && p < end) continue;
    const Index row = p < first ? p : p - k;
    A.startVec(row);
    for (Matrix::InnerIterator e(system.A, p); e; ++e)
      if (e.col() < first || e.col() >= end)
        A.insertBack(row, e.col() < first ? e.col() : e.col() - k) = e.value();
  }
  A.finalize();
  return A;
}

}  // namespace frictioncg
