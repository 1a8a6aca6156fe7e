#include "multigrid/bordered_hierarchy.h"

namespace frictioncg {

namespace {
/// S gets this share of the border's D in addition: an obstacle that no face holds makes it
/// singular, and one that a single node holds is softer than D by their number.
constexpr Real shift = 1e-10;
}  // namespace

BorderedHierarchy::BorderedHierarchy(const System& system, std::unique_ptr<LevelHierarchy> bodies)
    : system_(system),
      bodies_(std::move(bodies)),
      first_(system.interior() - static_cast<Index>(system.border.cols())),
      border_(static_cast<Index>(system.border.cols())),
      at_contact_(DenseMatrix(system.border).bottomRows(system.contact_dofs())),
      place_(system.dofs(), -1),
      Z_(system.border),
      r_(system.dofs()),
      z_(system.dofs()) {
  for (Index p = system.interior(); p < system.dofs(); ++p)
    for (Matrix::InnerIterator a(system.entries(), p); a; ++a) {
      const Index i = static_cast<Index>(a.col());
      if (place_[i] >= 0 || (i >= first_ && i < first_ + border_)) continue;
      place_[i] = static_cast<Index>(near_.size());
      near_.push_back(i);
    }
}

/// B and S. Z is the border without what is fixed, Y, and A border = 0:   A Z = -A Y,  Z'A Z = Y'A
/// Y
Border BorderedHierarchy::border(const std::vector<char>& fixed,
                                 const std::vector<TangentialStiffness>& W,
                                 const Vector& springs) const {
  const Index contact = static_cast<Index>(fixed.size()), interior = system_.interior();
  DenseMatrix B = DenseMatrix::Zero(near_.size(), border_);
  DenseMatrix S = shift * DenseMatrix(system_.D.segment(first_, border_).asDiagonal());
  for (Index c = 0; c < contact; ++c) {
    if (!fixed[c]) continue;
    for (Matrix::InnerIterator a(system_.entries(), interior + c); a; ++a)
      if (place_[a.col()] >= 0) B.row(place_[a.col()]) -= a.value() * at_contact_.row(c);
  }
  for (Index c = 0; c < contact; ++c) {
    const Index p = place_[interior + c];
    if (fixed[c]) {
      S -= at_contact_.row(c).transpose() * B.row(p);
      B.row(p).setZero();
    } else if (springs.size() > 0) {
      B.row(p) += springs[c] * at_contact_.row(c);
      S += springs[c] * at_contact_.row(c).transpose() * at_contact_.row(c);
    }
  }
  for (const TangentialStiffness& w : W) {
    const DenseMatrix Z = at_contact_.middleRows(w.first - interior, 2), MZ = w.M * Z;
    for (Index t = 0; t < 2; ++t) B.row(place_[w.first + t]) += MZ.row(t);
    S += Z.transpose() * MZ;
  }
  return {near_, B, S};
}

void BorderedHierarchy::truncate(const std::vector<char>& fixed,
                                 const std::vector<TangentialStiffness>& W, const Vector& springs) {
  Z_ = system_.border;
  Z_.prune([&](Index p, Index, Real) {
    return p < system_.interior() || !fixed[p - system_.interior()];
  });
  Border of_bodies = border(fixed, W, springs);
  for (Index& p : of_bodies.row)
    if (p >= first_) p -= border_;
  std::vector<TangentialStiffness> W_of_bodies = W;
  for (TangentialStiffness& w : W_of_bodies) w.first -= border_;
  bodies_->join(of_bodies);
  bodies_->truncate(fixed, W_of_bodies, springs);
}

void BorderedHierarchy::apply(const Vector& r, Vector& z) {
  const Index behind = static_cast<Index>(r.size()) - first_ - border_;
  r_.head(first_) = r.head(first_);
  r_.segment(first_, behind) = r.tail(behind);
  r_.tail(border_).noalias() = Z_.transpose() * r;
  bodies_->apply(r_, z_);
  z.noalias() = Z_ * z_.tail(border_);
  z.head(first_) += z_.head(first_);
  z.tail(behind) += z_.segment(first_, behind);
}

double BorderedHierarchy::bytes() const {
  return bodies_->bytes() + (sizeof(Real) + sizeof(Index)) * double(Z_.nonZeros()) +
         sizeof(Real) * double(at_contact_.size()) +
         sizeof(Index) * double(near_.size() + place_.size());
}

Matrix without_border(const System& system) {
  const Index k = static_cast<Index>(system.border.cols()), n = system.dofs();
  const Index end = system.interior(), first = end - k;
  Matrix A(n - k, n - k);
  A.reserve(system.entries().nonZeros());
  for (Index p = 0; p < n; ++p) {
    if (p >= first && p < end) continue;
    const Index row = p < first ? p : p - k;
    A.startVec(row);
    for (Matrix::InnerIterator e(system.entries(), p); e; ++e)
      if (e.col() < first || e.col() >= end)
        A.insertBack(row, e.col() < first ? e.col() : e.col() - k) = e.value();
  }
  A.finalize();
  return A;
}

}  // namespace frictioncg
