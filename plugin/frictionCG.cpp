// frictionCG: unilateral contact with Coulomb friction for FreeFEM, by the conjugate gradient of
// Raous and Barbarin (1992) and by condensation.  Registers frictionalContactCG and contactproblem:
// the operators are in freefem/, the numerics in core/.
//
// SPDX-License-Identifier: GPL-3.0-or-later

#include "freefem/freefem.h"

#include "freefem/load.h"
#include "freefem/memory.h"
#include "freefem/operators.h"
#include "freefem/usage.h"

namespace frictioncg {
namespace {

void load() {
  check_version();
  if (is_loaded()) return;  // frictionCG-mpi has all of this, and macros load frictionCG by name
  if (!take_buffer_of_blas())
    throw ErrorLoad("frictionCG: not enough memory for a buffer of BLAS", 1);
  register_contactproblem();
  for_each_site<v_fes>(add_site);
  for_each_site<v_fes3>(add_site);
  Global.Add(operator_name, "(", new OneOperatorCode<SolveIncrement>());
  Global.Add(operator_name, "(", new OneOperatorCode<Renew>());
  add_usage();
  add_version();
}

}  // namespace
}  // namespace frictioncg

LOADFUNC(frictioncg::load)
