#include "gradient/preconditioner.h"

namespace frictioncg {

namespace {

class SsorPreconditioner final : public Preconditioner {
 public:
  SsorPreconditioner(const System& system, bool on_hessian, Real omega)
      : Preconditioner(system),
        on_hessian_(on_hessian),
        omega_(omega),
        kappa_((2 - omega) / omega),
        A_(arrays_of(system.entries())),
        diagonal_(system.dofs()),
        C_(D_),
        inverse_(omega * D_.cwiseInverse()),
        free_(system.contact_dofs(), 1),
        y_(Vector::Zero(system.dofs())),
        s_(Vector::Zero(system.dofs())),
        e_(Vector::Zero(system.dofs())),
        r_C_(Vector::Zero(system.contact_dofs())),
        E_y_(Vector::Zero(system.contact_dofs())),
        dr_C_(Vector::Zero(system.contact_dofs())),
        dE_y_(Vector::Zero(system.contact_dofs())),
        dy_C_(Vector::Zero(system.contact_dofs())),
        dy_I_(Vector::Zero(system.interior())) {
    const auto [row, col, a] = A_;
    for (Index i = 0; i < system.dofs(); ++i)
      diagonal_[i] = static_cast<Index>(std::lower_bound(col + row[i], col + row[i + 1], i) - col);
  }

  void start(const Vector& r) override {
    interior_r_z_ = interior_dr_z_ = 0;
    for (Index i = 0; i < interior_; ++i) {
      y_[i] = less_lower(r[i], i, y_.data()) * inverse_[i];
      interior_r_z_ += kappa_ * C_[i] * y_[i] * y_[i];
    }
  }

  void set_contact(const Vector& r_C, const ContactPart& part) override {
    const auto [row, col, a] = A_;
    const Real* y = y_.data();
    free_ = part.free;
    if (on_hessian_ && C_.tail(r_C.size()) != D_.tail(r_C.size()) + part.hessian) {
      C_changed_ = true;
      C_.tail(r_C.size()) = D_.tail(r_C.size()) + part.hessian;
      inverse_.tail(r_C.size()) = omega_ * C_.tail(r_C.size()).cwiseInverse();
    }

    // E_CI y_I and, for Polak-Ribiere, the image of the change of r under the present (C/omega +
    // E)^{-1}
    for (Index c = 0; c < r_C.size(); ++c) {
      Real sum = 0;
      const Index i = interior_ + c;
      for (Index k = row[i]; k < diagonal_[i] && col[k] < interior_; ++k) sum += a[k] * y[col[k]];
      dE_y_[c] = sum - E_y_[c];
      dr_C_[c] = r_C[c] - r_C_[c];
      E_y_[c] = sum;
      r_C_[c] = r_C[c];
    }
    forward_contact(dE_y_, dr_C_, dy_C_.data());
    forward_contact(E_y_, r_C_, y_.data() + interior_);

    r_z_ = interior_r_z_;
    dr_z_ = interior_dr_z_;
    for (Index c = 0; c < r_C.size(); ++c) {
      const Index i = interior_ + c;
      r_z_ += kappa_ * C_[i] * y_[i] * y_[i];
      dr_z_ += kappa_ * C_[i] * dy_C_[c] * y_[i];
    }
  }

  /// s := kappa C y + gamma s, then (C/omega + E') v = s from the last row up. Each row ends on the
  /// entry that was computed last, so that the rest of its sum does not wait for it.
  void direction(Real gamma, Vector& v_out) override {
    const Real *C = C_.data(), *y = y_.data(), *inverse = inverse_.data();
    Real *s = s_.data(), *v = v_out.data();
    // On the contact rows C may have changed since s was formed: s = (C/omega + E') v anew.
    if (gamma != 0 && C_changed_)
      for (Index i = interior_; i < system_.dofs(); ++i)
        s[i] = -less_upper(-C[i] / omega_ * v[i], i, v);
    C_changed_ = false;
    for (Index i = system_.dofs() - 1; i >= interior_; --i) {
      if (!free_[i - interior_]) {
        s[i] = v[i] = 0;
        continue;
      }
      s[i] = kappa_ * C[i] * y[i] + (gamma != 0 ? gamma * s[i] : 0);
      v[i] = less_upper(s[i], i, v) * inverse[i];
    }
    for (Index i = interior_ - 1; i >= 0; --i) {
      s[i] = kappa_ * C[i] * y[i] + gamma * s[i];
      v[i] = less_upper(s[i], i, v) * inverse[i];
    }
  }

  /// (C/omega + E) e = s + (D - 2C/omega) v, so that A v = (C/omega + E)(v + e), and <Av,v> = <v+e,
  /// s>.
  Curvature curvature(const Vector& v_in) override {
    const Real *C = C_.data(), *v = v_in.data(), *s = s_.data(), *inverse = inverse_.data();
    Real* e = e_.data();
    const Real shift = 1 - 2 / omega_;
    Real vAv = 0, vDv = 0;
    for (Index i = 0; i < interior_; ++i) {
      const Real Cv = C[i] * v[i];
      e[i] = less_lower(s[i] + shift * Cv, i, e) * inverse[i];
      vAv += (v[i] + e[i]) * s[i];
      vDv += Cv * v[i];
    }
    for (Index i = interior_; i < system_.dofs(); ++i) {
      e[i] = 0;
      if (!free_[i - interior_]) continue;
      e[i] = less_lower(s[i] + (D_[i] - 2 / omega_ * C[i]) * v[i], i, e) * inverse[i];
      vAv += (v[i] + e[i]) * s[i];
      vDv += D_[i] * v[i] * v[i];
    }
    return {vAv, vDv};
  }

  void advance(Real rho, const Vector& v_in, Vector& x_out) override {
    const Real *C = C_.data(), *v = v_in.data(), *e = e_.data();
    Real *y = y_.data(), *x = x_out.data();
    Real r_z = 0, dr_z = 0;
    for (Index i = 0; i < interior_; ++i) {
      const Real dy = -rho * (v[i] + e[i]);
      x[i] += rho * v[i];
      y[i] += dy;
      const Real w = C[i] * y[i];
      r_z += y[i] * w;
      dr_z += dy * w;
    }
    x_out.tail(system_.contact_dofs()) += rho * v_in.tail(system_.contact_dofs());
    interior_r_z_ = kappa_ * r_z;
    interior_dr_z_ = kappa_ * dr_z;
  }

  /// y_I -= dy_I = (C/omega + E)_II^{-1} A_IC dx_C.
  void move_contact(const Vector& dx_C) override {
    const auto [row, col, a] = A_;
    const Real* dx = dx_C.data();
    interior_r_z_ = 0;
    for (Index i = 0; i < interior_; ++i) {
      Real sum = 0;
      for (Index k = row[i + 1] - 1; k > diagonal_[i] && col[k] >= interior_; --k)
        sum += a[k] * dx[col[k] - interior_];
      dy_I_[i] = less_lower(sum, i, dy_I_.data()) * inverse_[i];
      y_[i] -= dy_I_[i];
      interior_r_z_ += kappa_ * C_[i] * y_[i] * y_[i];
    }
  }

  Real r_z() const override { return r_z_; }
  Real dr_z() const override { return dr_z_; }
  Real r_v(const Vector&) const override { return y_.dot(s_); }
  Real free_norm() const override {
    Real sum = 0;
    for (Index i = 0; i < interior_; ++i) {
      const Real r = -less_lower(-C_[i] / omega_ * y_[i], i, y_.data());
      sum += r * r / system_.weight[i];
    }
    for (Index c = 0; c < r_C_.size(); ++c)
      if (free_[c]) sum += r_C_[c] * r_C_[c] / system_.weight[interior_ + c];
    return std::sqrt(sum);
  }

 private:
  /// sum less what row i of A has left of the diagonal, times y.
  Real less_lower(Real sum, Index i, const Real* y) const {
    for (Index k = A_.row[i]; k < diagonal_[i]; ++k) sum -= A_.a[k] * y[A_.col[k]];
    return sum;
  }
  /// ... right of the diagonal, from the last column on.
  Real less_upper(Real sum, Index i, const Real* v) const {
    for (Index k = A_.row[i + 1] - 1; k > diagonal_[i]; --k) sum -= A_.a[k] * v[A_.col[k]];
    return sum;
  }

  /// y_C = (C/omega + E)_CC^{-1} (rhs - lower_interior) on the free contact dofs.
  void forward_contact(const Vector& lower_interior, const Vector& rhs, Real* y_C) const {
    const auto [row, col, a] = A_;
    for (Index c = 0; c < rhs.size(); ++c) {
      const Index i = interior_ + c;
      Real sum = 0;
      if (free_[c]) {
        sum = rhs[c] - lower_interior[c];
        for (Index k = diagonal_[i] - 1; k >= row[i] && col[k] >= interior_; --k)
          sum -= a[k] * y_C[col[k] - interior_];
        sum *= inverse_[i];
      }
      y_C[c] = sum;
    }
  }

  const bool on_hessian_;
  const Real omega_, kappa_;  ///< kappa = (2 - omega)/omega
  const Arrays A_;
  std::vector<Index> diagonal_;  ///< n, position of a_ii in the row
  Vector C_;                     ///< n, D of A or of J''
  Vector inverse_;               ///< n, omega/C
  std::vector<char> free_;       ///< contact dofs
  Vector y_;                     ///< (C/omega + E)^{-1} r, zero where masked
  Vector s_;                     ///< (C/omega + E') v
  Vector e_;                     ///< A v = (C/omega + E)(v + e)
  Vector r_C_, E_y_;             ///< contact dofs: r; E_CI y_I
  Vector dr_C_, dE_y_, dy_C_;    ///< what set_contact has changed of r, E_CI y_I and y
  Vector dy_I_;                  ///< interior dofs: what move_contact has changed of y
  bool C_changed_ = false;       ///< since s was formed
  Real r_z_ = 0, dr_z_ = 0, interior_r_z_ = 0, interior_dr_z_ = 0;
};

}  // namespace

std::unique_ptr<Preconditioner> make_ssor(const System& system, bool on_hessian, Real omega) {
  return std::make_unique<SsorPreconditioner>(system, on_hessian, omega);
}

}  // namespace frictioncg
