#pragma once
#include "gradient/release_rule.h"

namespace frictioncg {

/// GC2 (Dilintas, section 3): nodes under tension are let go at each iteration, and the conjugation
/// goes on.
class Gc2 final : public ReleaseRule {
 public:
  Real threshold(Real, Real) const override { return std::numeric_limits<Real>::infinity(); }
  bool release(Iterate& it, Real least) override {
    return it.faces.open_tensile(it.rows.r(), least);
  }
  bool restarts() const override { return false; }
};

}  // namespace frictioncg
