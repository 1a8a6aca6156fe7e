#pragma once
#include "gradient/residual_preconditioner.h"

namespace frictioncg {

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

}  // namespace frictioncg
