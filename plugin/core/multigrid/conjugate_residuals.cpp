#include "multigrid/conjugate_residuals.h"

#include "threads.h"

namespace frictioncg {

namespace {

/// A new direction is made orthogonal to so many of the last ones.
constexpr std::size_t most_directions = 20;
/// A is not positive semi-definite where -<Az,z>/<Dz,z> is larger: rounding makes no more.
constexpr Real negative = 1e-10;
/// A direction of which this share of |Jz|^2 is left beside the others is rounding.
constexpr Real dependent = 1e-20;

/// Rows first .. end-1 of vectors
struct Rows {
  Index first, end;
  auto of(const Vector& v) const { return v.segment(first, end - first).array(); }
  auto of(Vector& v) const { return v.segment(first, end - first).array(); }
};

}  // namespace

ConjugateResiduals::ConjugateResiduals(const System& system)
    : system_(system), inverse_weight_(system.weight.cwiseInverse()) {}

/// The part of this process in the product of norm_D.
Real ConjugateResiduals::dot(const Vector& a, const Vector& b) const {
  return sum_of_ranges(Index(a.size()), [&](Index first, Index end) {
    const Rows rows{first, end};
    return (rows.of(a) * rows.of(inverse_weight_) * rows.of(b)).sum();
  });
}

void ConjugateResiduals::start(const Vector& s) {
  s_ = s;
  norm_ = std::sqrt(system_.sum(dot(s_, s_)));
  used_ = next_ = 0;
}

bool ConjugateResiduals::step(Hierarchy& hierarchy, const Faces& faces, const Vector& springs,
                              Vector& x, Vector& b_C) {
  if (kept_.size() < most_directions && next_ == kept_.size()) kept_.emplace_back();
  Direction& now = kept_[next_];
  const Index n = static_cast<Index>(x.size());
  hierarchy.apply(s_, now.z);
  if (!hierarchy.multiply(now.z, now.Jz)) system_.multiply(now.z, now.Jz);
  const Eigen::Array2d work_size = sum_of_ranges(n, [&](Index first, Index end) {
    const Rows rows{first, end};
    return Eigen::Array2d{(rows.of(now.z) * rows.of(now.Jz)).sum(),
                          (rows.of(now.z).square() * rows.of(system_.D)).sum()};
  });
  now.Az_C = now.Jz.tail(springs.size()) + springs.cwiseProduct(now.z.tail(springs.size()));
  faces.jacobian(now.z, now.Az_C, now.Jz.tail(system_.contact_dofs()));
  if (!make_orthogonal(now, work_size)) return false;
  Real along[] = {dot(now.Jz, now.Jz), dot(s_, now.Jz)};
  system_.sum(along, 2);
  now.size = along[0];
  if (!(now.size > dependent * before_)) return false;
  const Real alpha = along[1] / now.size;
  in_ranges(n, [&](Index first, Index end) {
    const Rows rows{first, end};
    rows.of(x) += alpha * rows.of(now.z);
    rows.of(s_) -= alpha * rows.of(now.Jz);
  });
  b_C -= alpha * now.Az_C;
  norm_ = std::sqrt(system_.sum(dot(s_, s_)));
  used_ = std::max(used_, next_ + 1);
  next_ = (next_ + 1) % most_directions;
  return alpha != 0;
}

/// Takes the directions before out of a new one, by one sum over all processes (classical
/// Gram-Schmidt). work_size: the parts of this process in <Az,z> and <Dz,z>; false where A did
/// negative work.
bool ConjugateResiduals::make_orthogonal(Direction& now, const Eigen::Array2d& work_size) {
  const Index n = static_cast<Index>(now.z.size());
  using Products = Eigen::Array<Real, int(most_directions) + 3, 1>;
  Products products = sum_of_ranges(n, [&](Index first, Index end) {
    const Rows rows{first, end};
    Products part = Products::Zero();
    const auto with = [&](const Vector& Jz) {
      return (rows.of(now.Jz) * rows.of(inverse_weight_) * rows.of(Jz)).sum();
    };
    part[2] = with(now.Jz);
    for (std::size_t k = 0; k < used_; ++k)
      if (&kept_[k] != &now) part[Index(k) + 3] = with(kept_[k].Jz);
    return part;
  });
  products.head(2) = work_size;
  system_.sum(products.data(), static_cast<Index>(used_) + 3);
  before_ = products[2];
  indefinite_ = products[0] < -negative * products[1];
  if (indefinite_) return false;
  const auto along = [&](std::size_t k) { return products[Index(k) + 3] / kept_[k].size; };
  in_ranges(n, [&](Index first, Index end) {
    const Rows rows{first, end};
    for (std::size_t k = 0; k < used_; ++k) {
      if (&kept_[k] == &now) continue;
      rows.of(now.z) -= along(k) * rows.of(kept_[k].z);
      rows.of(now.Jz) -= along(k) * rows.of(kept_[k].Jz);
    }
  });
  for (std::size_t k = 0; k < used_; ++k)
    if (&kept_[k] != &now) now.Az_C -= along(k) * kept_[k].Az_C;
  return true;
}

}  // namespace frictioncg
