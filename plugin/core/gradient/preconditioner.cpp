#include "gradient/preconditioner.h"

#include "gradient/diagonal.h"
#include "gradient/multigrid.h"
#include "gradient/ssor.h"

namespace frictioncg {

Preconditioner::Preconditioner(const System& system)
    : system_(system), interior_(system.interior()), D_(system.D) {}

std::unique_ptr<Preconditioner> make_preconditioner(const System& system, Precon kind, Real omega) {
  switch (kind) {
    case Precon::ssor:
      return std::make_unique<SsorPreconditioner>(system, false, omega);
    case Precon::hessian_ssor:
      return std::make_unique<SsorPreconditioner>(system, true, omega);
    case Precon::multigrid:
      return std::make_unique<MultigridPreconditioner>(system);
    default:
      return std::make_unique<DiagonalPreconditioner>(system, kind);
  }
}

}  // namespace frictioncg
