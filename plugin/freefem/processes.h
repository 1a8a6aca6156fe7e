#pragma once
#include "../core/types.h"

namespace frictioncg {

/// Those that have parts of one mesh, overlapping, and call the same functions in the same order;
/// by default there is one, which has all of it.
struct Processes {
  virtual ~Processes() = default;
  virtual bool owns(Index /*dof*/) const { return true; }
  virtual void sum(Real* /*values*/, Index /*count*/) const {}
  virtual void largest(Real* /*values*/, Index /*count*/) const {}
  Real largest(Real value) const {
    largest(&value, 1);
    return value;
  }
  /// Runs what each does by itself. What one of them throws, all throw.
  virtual void agree(const std::function<void()>& body) const { body(); }
};

}  // namespace frictioncg
