#pragma once
#include "../freefem/freefem.h"

#include <new>

#include "domain.h"

namespace frictioncg {

/// Runs the body of an operator on all processes of the communicator; its rank 0 alone says what
/// went wrong. What one of them throws where it cannot be agreed upon ends them all.
template <class Body>
AnyType together(const char* name, MPI_Comm communicator, Body body) {
  std::string message;
  try {
    try {
      return body();
    } catch (const IllegalInput& e) {  // agreed upon
      int rank;
      MPI_Comm_rank(communicator, &rank);
      message = rank == 0 ? name + std::string(": ") + e.what() : name;
    }
  } catch (const std::bad_alloc&) {
    end_all(communicator, name, not_enough_memory);
  } catch (const std::exception& e) {
    end_all(communicator, name, e.what());
  } catch (...) {
    end_all(communicator, name, "an expression of the script failed");
  }
  ExecError(message);
  return Nothing;
}

}  // namespace frictioncg
