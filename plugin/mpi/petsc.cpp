#include "petsc.h"

#include <new>
#include <stdexcept>
#include <string>

namespace frictioncg {

namespace {
bool ours = false;  ///< another plugin may have started PETSc, and ends it
PetscErrorCode first_error = {};
bool failed = false;

/// Some versions of PETSc, 3.18 among them, pass on the line for the code where memory runs out.
PetscErrorCode remember(MPI_Comm, int, const char* function, const char*, PetscErrorCode error,
                        PetscErrorType type, const char*, void*) {
  if (type != PETSC_ERROR_INITIAL) return error;
  const std::string where = function ? function : "";
  const bool memory = where == "PetscMallocAlign" || where == "PetscReallocAlign";
  first_error = memory ? PETSC_ERR_MEM : error;
  return error;
}
}  // namespace

void check(PetscErrorCode error) {
  if (!error) return;
  failed = true;
  const char* text = nullptr;
  if (first_error) error = first_error;
  first_error = {};
  if (error == PETSC_ERR_MEM) throw std::bad_alloc();
  PetscErrorMessage(error, &text, nullptr);
  throw std::runtime_error("PETSc: " +
                           (text ? std::string(text) : "error " + std::to_string(error)));
}

bool petsc_failed() { return failed; }

void start_petsc() {
  PetscBool started = PETSC_FALSE;
  check(PetscInitialized(&started));
  if (started) return;
  static int count = 0;
  static char** arguments = nullptr;
  check(PetscInitialize(&count, &arguments, nullptr, nullptr));
  ours = true;
  // errors are thrown, and said once
  check(PetscPushErrorHandler(remember, nullptr));
  // a crash is left to mpirun: PETSc's way to end the others hangs where memory has run out
  check(PetscPopSignalHandler());
}

Traffic petsc_traffic() {
#if defined(PETSC_USE_LOG)
  return {petsc_isend_ct + petsc_send_ct, petsc_isend_len + petsc_send_len,
          petsc_allreduce_ct + petsc_gather_ct + petsc_scatter_ct};
#else
  return {};
#endif
}

void end_petsc() {
  if (ours) PetscFinalize();
}

}  // namespace frictioncg
