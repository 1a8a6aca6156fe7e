#pragma once
#include "gradient/release_rule.h"

namespace frictioncg {

/// GC2 (Dilintas, section 3): nodes under tension are let go at each iteration, and the conjugation
/// goes on.
class Gc2 final : public ReleaseRule {
 public:
  bool at_once() const override { return true; }
  Real threshold(Real, Real) const override { return 0; }
  bool release(Iterate& it, Real least) override {
    return it.faces.open_tensile(it.rows.r(), least);
  }
  bool restarts() const override { return false; }
};

}  // namespace frictioncg
