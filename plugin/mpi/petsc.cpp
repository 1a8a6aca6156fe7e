#include "petsc.h"

#include <iterator>
#include <new>

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

constexpr const char* phase_names[] = {"fCGPose",  "fCGPairing", "fCGHierarchy", "fCGSolve",
                                       "fCGFaces", "fCGCycle",   "fCGProduct"};
PetscLogEvent events[std::size(phase_names)];

void name_phases() {
  static bool named = false;
  if (named) return;
  PetscClassId id;
  check(PetscClassIdRegister("frictionCG", &id));
  for (std::size_t k = 0; k < std::size(phase_names); ++k)
    check(PetscLogEventRegister(phase_names[k], id, &events[k]));
  named = true;
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

void start_petsc(const std::vector<std::string>& arguments) {
  PetscBool started = PETSC_FALSE;
  check(PetscInitialized(&started));
  if (started) return name_phases();
  // PETSc keeps them to its end
  static std::vector<std::string> kept = arguments;
  static std::vector<char*> words;
  for (std::string& word : kept) words.push_back(&word[0]);
  words.push_back(nullptr);
  static int count = static_cast<int>(kept.size());
  static char** all = words.data();
  check(PetscInitialize(&count, &all, nullptr, nullptr));
  ours = true;
  // errors are thrown, and said once
  check(PetscPushErrorHandler(remember, nullptr));
  // a crash is left to mpirun: PETSc's way to end the others hangs where memory has run out
  check(PetscPopSignalHandler());
  name_phases();
}

Timed::Timed(Phase phase) : event_(events[static_cast<std::size_t>(phase)]) {
  check(PetscLogEventBegin(event_, nullptr, nullptr, nullptr, nullptr));
}
Timed::~Timed() {
  if (!failed) PetscLogEventEnd(event_, nullptr, nullptr, nullptr, nullptr);
}

void end_petsc() {
  if (ours) PetscFinalize();
}

}  // namespace frictioncg
