#include "gradient/multigrid.h"

namespace frictioncg {

namespace {

/// Where J'' adds so many times D to a tangent, the tangent leaves the hierarchy: A hardly matters
/// to it, and single precision would lose A beside it.
constexpr Real stiff = 100;
/// The hierarchy is made anew where the J'' of a tangent has changed by this share of D + J''.
constexpr Real outdated = 0.5;

/// The gradient methods have products with A of their own.
HierarchyOptions without_products() {
  HierarchyOptions options;
  options.multiplies = false;
  return options;
}

}  // namespace

MultigridPreconditioner::MultigridPreconditioner(const System& system)
    : ResidualPreconditioner(system),
      hierarchy_(make_hierarchy(system, without_products())),
      springs_(Vector::Zero(system.contact_dofs())) {
  if (!hierarchy_)
    throw IllegalInput(
        "precon=\"multigrid\" needs the mesh nodes and the rigid motions of A, as displacements in "
        "P1 or P2 on one mesh have them; take precon=\"hessian-ssor\"");
}

/// Whether the hierarchy as it is cut now is still one for these faces and this J''.
bool MultigridPreconditioner::fits(const ContactPart& part) const {
  if (cut_.empty()) return false;
  for (Index c = 0; c < springs_.size(); ++c) {
    const Real D = D_[interior_ + c], H = part.hessian[c];
    const bool cut = !part.free[c] || H > stiff * D;
    if (cut != bool(cut_[c])) return false;
    if (!cut && std::abs(H - springs_[c]) > outdated * (D + springs_[c])) return false;
  }
  return true;
}

void MultigridPreconditioner::update(const ContactPart& part) {
  free_ = part.free;
  hessian_ = part.hessian;
  if (fits(part)) return;
  cut_.assign(free_.size(), 0);
  for (Index c = 0; c < springs_.size(); ++c) {
    cut_[c] = !free_[c] || hessian_[c] > stiff * D_[interior_ + c];
    springs_[c] = cut_[c] ? 0 : hessian_[c];
  }
  hierarchy_->truncate(cut_, {}, springs_);
}

void MultigridPreconditioner::apply(const Vector& r, Vector& z) const {
  hierarchy_->apply(r, z);
  for (Index c = 0; c < springs_.size(); ++c) {
    const Index i = interior_ + c;
    if (cut_[c]) z[i] = free_[c] ? r[i] / (D_[i] + hessian_[c]) : 0;
  }
}

}  // namespace frictioncg
