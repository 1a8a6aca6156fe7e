// frictionCG for several processes: what frictionCG registers, with domain=, and the type
// contactdomain that createMat of FreeFEM's macro_ddm.idp fills.  The numerics are those of core/,
// on matrices and multigrid of PETSc.
//
// SPDX-License-Identifier: GPL-3.0-or-later

#include "../freefem/freefem.h"

#include "../freefem/load.h"
#include "shared_operators.h"

namespace frictioncg {
namespace {

constexpr const char* plugin_name = "frictionCG-mpi";

void end() {
  try {
    if (mpisize > 1) meet_at_end(plugin_name);
    end_petsc();
  } catch (const std::bad_alloc&) {
    end_all(MPI_COMM_WORLD, plugin_name, not_enough_memory);
  }
}

void load() {
  check_version();
  if (is_loaded())
    throw ErrorLoad(
        "frictionCG-mpi has all that frictionCG has; load it first, before frictionCG and its "
        "macros (frictionCG.idp)",
        1);
  if (!take_buffer_of_blas()) end_all(MPI_COMM_WORLD, plugin_name, not_enough_memory);
  register_contactproblem();
  register_contactdomain();
  // as an error of FreeFEM's: its end meets that of the process that could not, and mpirun of Open
  // MPI hangs where others abort meanwhile
  if (mpisize > 1 && !meet_at_load())
    throw ErrorLoad(
        "frictionCG-mpi: not loaded on all processes; is it there for each of them, and memory for "
        "it?",
        1);
  ff_atend(end);
  add_operators<SharedSolveOnce, SharedConstruct, SharedSolveIncrement>();
}

}  // namespace
}  // namespace frictioncg

LOADFUNC(frictioncg::load)
