#pragma once
// Eigen first: ff++.hpp redefines assert.
#include "../core/types.h"

#include "ff++.hpp"
#include "strversionnumber.hpp"

namespace frictioncg {

/// Evaluates an argument of the script. An error of FreeFEM's own in it keeps its words, and gets
/// the name of the argument; exit() is none.
template <class Body>
auto evaluated(const char* argument, Body body) -> decltype(body()) {
  try {
    return body();
  } catch (const ErrorExit&) {
    throw;
  } catch (const Error& e) {
    const std::string words = e.what();
    throw IllegalInput(argument + (": " + words.substr(0, words.find('\n'))));
  }
}

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
