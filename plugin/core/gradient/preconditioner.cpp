#include "gradient/preconditioner.h"

#include "model/contact_problem.h"
#include "multigrid/hierarchy.h"

namespace frictioncg {

namespace {

/// Where J'' adds so many times D to a tangent, the tangent leaves the hierarchy: A hardly matters
/// to it, and single precision would lose A beside it.
constexpr Real stiff = 100;
/// The hierarchy is made anew where the J'' of a tangent has changed by this share of D + J''.
constexpr Real outdated = 0.5;

/// A preconditioner that keeps r itself, and makes z = P r when it is asked for: a call without a
/// further step needs none. What is left to say is what P does.
class ResidualPreconditioner : public Preconditioner {
 public:
  explicit ResidualPreconditioner(const System& system)
      : Preconditioner(system),
        r_(Vector::Zero(system.dofs())),
        dr_(Vector::Zero(system.dofs())),
        Av_(Vector::Zero(system.dofs())) {}

  void start(const Vector& r) final {
    r_ = r;
    dr_.setZero();
    z_is_old_ = true;
  }

  void set_contact(const Vector& r_C, const ContactPart& part) final {
    for (Index c = 0; c < r_C.size(); ++c) {
      const Real before = r_[interior_ + c], now = part.free[c] ? r_C[c] : 0;
      dr_[interior_ + c] = now - before;
      r_[interior_ + c] = now;
    }
    z_is_old_ = true;
    update(part);
  }

  void direction(Real gamma, Vector& v) final { v = z() + gamma * v; }

  Curvature curvature(const Vector& v) final {
    system_.multiply(v, Av_);
    return {Av_.dot(v), (D_.array() * v.array().square()).sum()};
  }

  void advance(Real rho, const Vector& v, Vector& x) final {
    x += rho * v;
    dr_.head(interior_) = -rho * Av_.head(interior_);
    r_.head(interior_) += dr_.head(interior_);
  }

  void move_contact(const Vector& dx_C) final { system_.move_contact(dx_C, r_); }
  Real r_z() const final { return z(), products_.r_z; }
  Real dr_z() const final { return z(), products_.dr_z; }
  Real r_v(const Vector& v) const final { return r_.dot(v); }
  Real free_norm() const final { return norm_D(system_, r_); }

 protected:
  /// z = P r (n). r is 0 on the dofs that are not free, and z is to be.
  virtual void apply(const Vector& r, Vector& z) const = 0;
  /// The mask or the Hessian may have changed.
  virtual void update(const ContactPart& part) = 0;

 private:
  const Vector& z() const {
    if (!z_is_old_) return z_;
    z_is_old_ = false;
    apply(r_, z_);
    products_ = {r_.dot(z_), dr_.dot(z_)};
    return z_;
  }

  Vector r_;   ///< n, zero where held
  Vector dr_;  ///< n, its change by the last advance and what follows it
  Vector Av_;  ///< n, of the last direction
  // as of the last set_contact, made when they are asked for
  mutable Vector z_;  ///< n, P r
  mutable struct { Real r_z, dr_z; } products_{0, 0};
  mutable bool z_is_old_ = true;
};

/// C = I, diag(A) or diag(J'').
class DiagonalPreconditioner final : public ResidualPreconditioner {
 public:
  DiagonalPreconditioner(const System& system, Precon kind)
      : ResidualPreconditioner(system),
        on_hessian_(kind == Precon::hessian_diagonal),
        C_(kind == Precon::none ? Vector::Ones(system.dofs()) : Vector(D_)) {}

 private:
  void apply(const Vector& r, Vector& z) const override { z = r.cwiseQuotient(C_); }
  void update(const ContactPart& part) override {
    if (on_hessian_) C_.tail(part.hessian.size()) = D_.tail(part.hessian.size()) + part.hessian;
  }

  const bool on_hessian_;
  Vector C_;  ///< the diagonal
};

/// One cycle of the hierarchy of A on the free face: held dofs are cut out on every level. What
/// friction adds (J'') enters as springs on the tangents; those whose regularization is far stiffer
/// than A leave the hierarchy, too, and get r over their stiffness: single precision would lose A
/// beside them.
class MultigridPreconditioner final : public ResidualPreconditioner {
 public:
  explicit MultigridPreconditioner(const System& system)
      : ResidualPreconditioner(system),
        // the gradient methods have products with A of their own
        hierarchy_(make_hierarchy(system, {/*multiplies=*/false})),
        springs_(Vector::Zero(system.contact_dofs())) {
    if (!hierarchy_)
      throw IllegalInput(
          "precon=\"multigrid\" needs the mesh nodes and the rigid motions of A, as displacements "
          "in P1 or P2 on one mesh have them; take precon=\"hessian-ssor\"");
  }

 private:
  void apply(const Vector& r, Vector& z) const override {
    hierarchy_->apply(r, z);
    for (Index c = 0; c < springs_.size(); ++c) {
      const Index i = interior_ + c;
      if (cut_[c]) z[i] = part_.free[c] ? r[i] / (D_[i] + part_.hessian[c]) : 0;
    }
  }

  void update(const ContactPart& part) override {
    part_ = part;
    if (fits()) return;
    cut_.resize(part.free.size());
    for (Index c = 0; c < springs_.size(); ++c) {
      cut_[c] = leaves(c);
      springs_[c] = cut_[c] ? 0 : part.hessian[c];
    }
    hierarchy_->truncate(cut_, {}, springs_);
  }

  bool leaves(Index c) const {
    return !part_.free[c] || part_.hessian[c] > stiff * D_[interior_ + c];
  }

  /// Whether the hierarchy as it is cut now is still one for these faces and this J''.
  bool fits() const {
    if (cut_.empty()) return false;
    for (Index c = 0; c < springs_.size(); ++c) {
      const Real D = D_[interior_ + c], H = part_.hessian[c];
      if (leaves(c) != bool(cut_[c])) return false;
      if (!cut_[c] && std::abs(H - springs_[c]) > outdated * (D + springs_[c])) return false;
    }
    return true;
  }

  const std::unique_ptr<Hierarchy> hierarchy_;
  std::vector<char> cut_;  ///< contact dofs that the hierarchy leaves out
  Vector springs_;         ///< contact_dofs, what the hierarchy has of J'' [force/length]
  ContactPart part_;
};

}  // namespace

std::unique_ptr<Preconditioner> make_preconditioner(const System& system, Precon kind, Real omega) {
  switch (kind) {
    case Precon::ssor:
      return make_ssor(system, false, omega);
    case Precon::hessian_ssor:
      return make_ssor(system, true, omega);
    case Precon::multigrid:
      return std::make_unique<MultigridPreconditioner>(system);
    default:
      return std::make_unique<DiagonalPreconditioner>(system, kind);
  }
}

}  // namespace frictioncg
