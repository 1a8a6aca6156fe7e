// frictionCG: unilateral contact with Coulomb friction for FreeFEM, by the conjugate gradient of
// Raous and Barbarin (1992) and by condensation.  Registers frictionalContactCG and contactproblem:
// the operators are in freefem/, the numerics in core/.
//
// SPDX-License-Identifier: GPL-3.0-or-later

#include "freefem/freefem.h"

#include "freefem/load.h"
#include "freefem/operators.h"

namespace frictioncg {
namespace {

void load() {
  check_version();
  if (is_loaded()) return;  // frictionCG-mpi has all of this, and macros load frictionCG by name
  if (!take_buffer_of_blas())
    throw ErrorLoad("frictionCG: not enough memory for a buffer of BLAS", 1);
  register_contactproblem();
  add_operators<SolveOnce, Construct, SolveIncrement>();
}

}  // namespace
}  // namespace frictioncg

LOADFUNC(frictioncg::load)
