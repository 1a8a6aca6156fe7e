#include "petsc.h"

#include <stdexcept>
#include <string>

namespace frictioncg {

namespace {
bool ours = false;  ///< another plugin may have started PETSc, and ends it
}

void check(PetscErrorCode error) {
  if (!error) return;
  const char* text = nullptr;
  PetscErrorMessage(error, &text, nullptr);
  throw std::runtime_error(std::string("PETSc: ") + (text ? text : "unknown error"));
}

void start_petsc() {
  PetscBool started = PETSC_FALSE;
  check(PetscInitialized(&started));
  if (started) return;
  static int count = 0;
  static char** arguments = nullptr;
  check(PetscInitialize(&count, &arguments, nullptr, nullptr));
  ours = true;
  // errors are thrown, and said once
  check(PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr));
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
