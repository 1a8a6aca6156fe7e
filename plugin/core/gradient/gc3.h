#pragma once
#include "gradient/release_rule.h"

namespace frictioncg {

/// GC3 (the paper, section 3): nodes under tension are let go after partial convergence, at eps_1 =
/// partial eps_0, with a restart. A node that the next direction drives back was let go on the
/// residual of the others, not on its own force: the next release waits for a smaller residual.
class Gc3 final : public ReleaseRule {
 public:
  /// partial: eps_1/eps_0, the paper's 100.
  explicit Gc3(Real partial) : partial_(partial) {}
  void start() override { now_ = partial_; }
  Real threshold(Real eps_0, Real) const override { return now_ * eps_0; }
  bool release(Iterate& it, Real least) override {
    return it.faces.open_tensile(it.rows.r(), least);
  }
  void blocked() override { now_ /= patience; }

 private:
  static constexpr Real patience = 10;  ///< tried 3 to 100: no difference beyond a few iterations
  const Real partial_;
  Real now_ = 0;
};

}  // namespace frictioncg
