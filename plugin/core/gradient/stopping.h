#pragma once
#include "types.h"

namespace frictioncg {

/// A measure that costs about half a pass over A, and what is known anyway and about proportional
/// to it, which tells when it is worth its cost.
class RareMeasure {
 public:
  /// Measures, or tells infinity where it is surely above `wanted`.
  template <class Measure>
  Real operator()(Real known, Real wanted, const Measure& measure) {
    if (ratio_ * known > wanted && ++since_ < measure_every) return infinity;
    const Real measured = measure();
    since_ = 0;
    ratio_ = known > 0 ? measured / known : 0;
    return measured;
  }

 private:
  static constexpr Index measure_every = 20;  ///< after so many times it is in any case
  Real ratio_ = 0;                            ///< of the last measure over what was known then
  Index since_ = 0;
};

}  // namespace frictioncg
