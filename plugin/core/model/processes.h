#pragma once
#include <functional>

#include "types.h"

namespace frictioncg {

/// Which part of a scene that hangs together each dof belongs to.
struct Bodies {
  std::vector<Index> of;  ///< n, numbered from 0
  Index count = 0;        ///< on all processes
};

/// What the processes that share a system say together. Each owns some of its dofs and nodes, holds
/// their rows, and vectors of that size; all call the same functions in the same order.
class Processes {
 public:
  virtual ~Processes() = default;

  virtual void multiply(const Vector& x, Vector& Ax) const = 0;  ///< own rows of A x
  virtual Vector magnitude(const Vector& x) const = 0;           ///< own rows of |A||x|
  /// Adds up each of the values over all processes, in place.
  virtual void sum(Real* values, Index count) const = 0;
  virtual Real largest(Real value) const = 0;
  /// The vectors of all processes, one after the other.
  virtual Vector gathered(const Vector& own) const = 0;
  /// One vector in place of those of all processes, of one size, by what stands for two of them.
  using Both = std::function<Vector(const Vector&, const Vector&)>;
  virtual Vector combined(const Vector& own, const Both& both) const = 0;
  virtual Bodies bodies() const = 0;  ///< in the graph of A
};

}  // namespace frictioncg
