#pragma once
#include <petscksp.h>

#include "domain.h"

namespace frictioncg {

/// Throws std::bad_alloc, or std::runtime_error with PETSc's own words.
void check(PetscErrorCode error);

/// An error of PETSc's has ended a call, and all processes with it.
bool petsc_failed();

/// MPI and PETSc are ready after it; FreeFEM's program may have started MPI. arguments: of the
/// command line, the program's name first; PETSc takes its options from them.
void start_petsc(const std::vector<std::string>& arguments);
/// For the end of the program, where PETSc was started here.
void end_petsc();

/// A phase of a call under the name that -log_view has for it, to the end of its block.
enum class Phase { pose, pairing, hierarchy, solve, faces, cycle, product };
class Timed {
 public:
  explicit Timed(Phase phase);
  ~Timed();
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  PetscLogEvent event_;
};

/// An object of PETSc's that is destroyed with its owner; not after an error, which leaves objects
/// half made.
template <class Object, PetscErrorCode (*destroy)(Object*)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(Object object) : object_(object) {}
  Handle(Handle&& from) noexcept : object_(std::exchange(from.object_, nullptr)) {}
  Handle& operator=(Handle&& from) noexcept {
    std::swap(object_, from.object_);
    return *this;
  }
  ~Handle() {
    PetscBool ended = PETSC_FALSE;
    PetscFinalized(&ended);
    if (object_ && !ended && !petsc_failed()) destroy(&object_);
  }
  Object get() const { return object_; }
  Object* fill() { return &object_; }  ///< for PETSc's constructors

 private:
  Object object_ = nullptr;
};

using MatHandle = Handle<Mat, MatDestroy>;
using VecHandle = Handle<Vec, VecDestroy>;
using PCHandle = Handle<PC, PCDestroy>;
using KSPHandle = Handle<KSP, KSPDestroy>;
using ScatterHandle = Handle<VecScatter, VecScatterDestroy>;

}  // namespace frictioncg
