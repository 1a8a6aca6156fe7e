#pragma once
#include "freefem.h"

#include <new>
#include <string>

#include "../core/types.h"

namespace frictioncg {

/// Runs the body of an operator. What it throws becomes an error of FreeFEM's that keeps its
/// message; FreeFEM would report any other exception without one.
template <class Body>
AnyType translated(const char* name, Body body) {
  try {
    return body();
  } catch (const IllegalInput& e) {
    ExecError(std::string(name) + ": " + e.what());
  } catch (const std::bad_alloc&) {
    ExecError(std::string(name) + ": not enough memory for this problem");
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    ExecError(std::string(name) + ": internal error: " + e.what());
  }
  return Nothing;
}

}  // namespace frictioncg
