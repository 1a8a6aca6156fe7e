#pragma once
#include "model/contact_problem.h"

namespace frictioncg {

/// The last answers of a history, and where they lead to.
class Past {
 public:
  void add(const Increment& increment, const Vector& x);
  void forget() { answers_ = 0; }
  /// Whether next() goes on from two answers.
  bool has_direction() const { return answers_ == 2; }

  /// x (n) where load and gaps go on as they went between the last two answers, by a share beta of
  /// that; empty where there is no answer, and the last one where there is no other.
  ///   x = x_1 + beta (x_1 - x_2),   beta = <f - f_1, f_1 - f_2> / |f_1 - f_2|^2
  ///   f = (F / w^{1/2}, w_N^{1/2} gap), w the weights: both are roots of an energy
  /// Where bodies touch without a gap, proportional loads have such fields for answers.
  Vector next(const System& system, const Increment& increment) const;

 private:
  struct Answer {
    Vector F, gap, x;
  };
  Answer last_, before_;
  int answers_ = 0;  ///< kept: 0, 1 or 2
};

}  // namespace frictioncg
