#pragma once
#include "gradient/release_rule.h"

namespace frictioncg {

/// GC1 (Jeusette and Sonzogni, section 3): nodes under tension are let go at each iteration, with a
/// restart.
class Gc1 final : public ReleaseRule {
 public:
  bool at_once() const override { return true; }
  Real threshold(Real, Real) const override { return 0; }
  bool release(Iterate& it, Real least) override {
    return it.faces.open_tensile(it.rows.r(), least);
  }
};

}  // namespace frictioncg
